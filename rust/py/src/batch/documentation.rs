//! Documentation that the functions share.

/// Documentation of the inputs that describe the air.
macro_rules! air {
    () => {
        "temperature : array_like
    Air temperature [degC].
relative_humidity : array_like, default 0.0
    Relative humidity over liquid water [1], 0 to 1.
pressure : array_like, default 101325.0
    Air pressure [Pa].
co2_mole_fraction : array_like, default 4e-4
    Mole fraction of carbon dioxide [1]."
    };
}

/// Documentation of the choice of a law.
macro_rules! law {
    () => {
        "law : str, default \"cramer\"
    Law for the speed of sound: a name of `laws()`, or an expression such as \"331.3+0.606*T\".
    Outside its domain nothing is clamped; to be fast, `domain_violations` tells the rows, and not this
    function.
frequency : array_like, default 0.0
    Frequency of the sound [Hz]; at 0 the air does not disperse."
    };
}

/// Documentation of the arguments that every function has, and of the errors.
macro_rules! options {
    ($result:literal) => {
        concat!(
            "out : ndarray, optional
    Where to put the result; a fresh array can cost more time than the computation. It may share
    memory with an input in any way: the result is the one for a copy of that input.
where : array_like of bool, optional
    Which rows to compute; the others keep what `out` holds, NaN without `out`.
n_threads : int, optional
    At most so many threads; every processor by default. One works alone on less than 100,000 rows, or
    500,000 where the law reads the temperature alone: starting a thread would take longer.

Returns
-------
",
            $result,
            "
    A float for plain numbers; else of the inputs' broadcast shape, of their type (pandas,
    xarray, dask, polars) and precision (float32 stays float32). NaN where an input is NaN.

Warns
-----
DomainWarning
    If a number, or one of 64 elements of an array, is no such quantity of air: 50 for a relative humidity.

Raises
------
UsageError
    If a name is unknown, shapes do not broadcast, an input does not hold numbers, or `out` does
    not fit the result or shares memory within itself.
"
        )
    };
}

pub(super) use {air, law, options};
