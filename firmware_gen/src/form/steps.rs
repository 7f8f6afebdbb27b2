//! Steps that several forms share.

use crate::ir::{Builder, Value};

/// Codes below the coldest that an index can be counted from, the coldest among them. A product with the index is zero
/// at its first code: the fraction of a unit by which the speed factor there is off cannot be cut off in another place,
/// unless the index starts elsewhere. Set by hand: so many codes of 1/16 degC change a factor of
/// 16 bits by more than two units.
pub(super) const INDEX_STARTS: i64 = 16;

/// The code of the condition that a form of one condition reads, usually the temperature, counted from the first that
/// the function accepts.
pub(super) fn temperature_index(builder: &mut Builder<'_>) -> Value {
    temperature_index_from(builder, 0)
}

/// The temperature code counted from so many codes `before` the coldest.
pub(super) fn temperature_index_from(builder: &mut Builder<'_>, before: i64) -> Value {
    let axis = &builder.device().conditions[builder.axis()];
    let first = axis.steps().minimum - before;
    let words = axis.word().replace('_', " ");
    let note = match (&axis.curve, before) {
        (Some(_), 1..) => format!("{words} code minus {first}"),
        _ => format!(
            "{words} code minus the code of {}",
            axis.with_unit(axis.value(first << axis.shift))
        ),
    };
    let code = builder.condition(builder.axis());
    if first == 0 {
        return code;
    }
    let value = plus(builder, code, -first);
    if before > 0 {
        return builder.name(value, "index", note);
    }
    let prefix = builder.set_prefix(""); // all forms in one program share this variable
    let value = builder.name(value, &format!("{}_index", axis.word()), note);
    builder.set_prefix(prefix);
    value
}

/// The code of the second condition, counted from the one with the least value: [`Axis::index`](crate::device::Axis::index).
pub(super) fn second_index(builder: &mut Builder<'_>) -> Value {
    let axis = &builder.device().conditions[1];
    let code = builder.condition(1);
    if axis.falls() {
        let last = builder.constant(axis.steps().maximum);
        return builder.subtract(last, code);
    }
    plus(builder, code, -axis.steps().minimum)
}

/// `value + constant`, written as a subtraction where the constant is negative and left out where it is zero.
pub(super) fn plus(builder: &mut Builder<'_>, value: Value, constant: i64) -> Value {
    match constant {
        0 => value,
        1.. => {
            let constant = builder.constant(constant);
            builder.add(value, constant)
        }
        i64::MIN => {
            let constant = builder.constant(constant); // it has no opposite
            builder.add(value, constant)
        }
        _ => {
            let constant = builder.constant(-constant);
            builder.subtract(value, constant)
        }
    }
}

/// `value >> bits`, rounded down, also where `value` can be negative.
pub(super) fn floor_shift(builder: &mut Builder<'_>, value: Value, bits: u32) -> Value {
    let lowest = builder.range(value).minimum;
    let lift = if lowest < 0 { 1 + (-lowest >> bits) } else { 0 };
    let lifted = plus(builder, value, lift << bits);
    let shifted = builder.shift_right(lifted, bits);
    plus(builder, shifted, -lift)
}
