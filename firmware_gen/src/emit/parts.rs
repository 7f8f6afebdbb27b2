//! Integers in parts of 14 bits, as texts: each part is small, so that MicroPython needs no object for it.

use crate::ir::Range;

/// Bits of a part. The product of a part and of 16 bits, with a carry, fits 31 bits with its sign.
pub(super) const PART: u32 = 14;
pub(super) const BELOW: Range = Range {
    minimum: 0,
    maximum: (1 << PART) - 1,
};
/// What an integer without an object holds where a word has 32 bits.
pub(super) const SMALL: Range = Range {
    minimum: -(1 << 30),
    maximum: (1 << 30) - 1,
};

/// A text and the values that it takes.
#[derive(Clone)]
pub(super) struct Term {
    pub text: String,
    pub range: Range,
}

/// A value: its parts, the lowest first; only the highest may be negative or have more bits.
pub(super) type Parts = Vec<Term>;

/// How many parts hold these values, so that the highest is small.
pub(super) fn number_of_parts(range: Range) -> usize {
    let mut rest = range;
    let mut count = 1;
    while !SMALL.covers(rest) {
        rest = shifted(rest, PART);
        count += 1;
    }
    count
}

pub(super) fn shifted(range: Range, bits: u32) -> Range {
    Range {
        minimum: range.minimum >> bits,
        maximum: range.maximum >> bits,
    }
}

/// Sum of the parts from bit `bits` on, as one expression.
pub(super) fn joined(parts: &[Term], bits: u32) -> String {
    let skipped = (bits / PART) as usize;
    let rest = bits % PART;
    let place = |(index, part): (usize, &Term)| {
        let up = PART * index as u32;
        match up.cmp(&rest) {
            std::cmp::Ordering::Equal => part.text.clone(),
            std::cmp::Ordering::Less => format!("({} >> {rest})", part.text),
            std::cmp::Ordering::Greater => format!("({} << {})", part.text, up - rest),
        }
    };
    let terms: Vec<_> = parts
        .iter()
        .skip(skipped)
        .enumerate()
        .map(place)
        .rev()
        .collect();
    let sum = if terms.is_empty() {
        "0".to_owned()
    } else {
        terms.join(" + ")
    };
    bare(&sum)
}

/// Without brackets around the whole.
pub(super) fn bare(text: &str) -> String {
    let inner = text
        .strip_prefix('(')
        .and_then(|rest| rest.strip_suffix(')'));
    // Brackets that close before others open belong to two parts: `(a) + (b)`.
    let mut depth = 0;
    let around = inner.is_some_and(|inner| {
        inner.chars().all(|letter| {
            depth += i32::from(letter == '(') - i32::from(letter == ')');
            depth >= 0
        })
    });
    inner.filter(|_| around).unwrap_or(text).to_owned()
}

/// Exact bounds of a sum of products.
pub(super) fn bounds(products: &[(&Term, &Term)], carry: Range) -> Range {
    let mut sum = carry;
    for (a, b) in products {
        let corners = [
            a.range.minimum * b.range.minimum,
            a.range.minimum * b.range.maximum,
            a.range.maximum * b.range.minimum,
            a.range.maximum * b.range.maximum,
        ];
        sum.minimum += corners.into_iter().fold(i64::MAX, i64::min);
        sum.maximum += corners.into_iter().fold(i64::MIN, i64::max);
    }
    sum
}

pub(super) fn term(text: String, range: Range) -> Term {
    Term { text, range }
}

pub(super) fn constant_term(value: i64) -> Term {
    term(
        value.to_string(),
        Range {
            minimum: value,
            maximum: value,
        },
    )
}

pub(super) fn constant_parts(constant: i64) -> Parts {
    let range = Range {
        minimum: constant,
        maximum: constant,
    };
    let count = number_of_parts(range) as u32;
    let part = |part: u32| {
        let rest = constant >> (PART * part);
        constant_term(if part + 1 == count {
            rest
        } else {
            rest & BELOW.maximum
        })
    };
    (0..count).map(part).collect()
}

/// The same value in `count` parts or more.
pub(super) fn split(parts: &[Term], count: usize) -> Parts {
    let mut found = parts.to_vec();
    while found.len() < count {
        let Some(top) = found.pop() else { break };
        match top.text.parse::<i64>() {
            Ok(constant) => {
                found.push(constant_term(constant & BELOW.maximum));
                found.push(constant_term(constant >> PART));
            }
            Err(_) => {
                found.push(term(format!("({} & {})", top.text, BELOW.maximum), BELOW));
                found.push(term(
                    format!("({} >> {PART})", top.text),
                    shifted(top.range, PART),
                ));
            }
        }
    }
    found
}

/// The same value in parts of which the highest, too, has 14 bits and a sign.
pub(super) fn fully(parts: &[Term]) -> Parts {
    let mut found = parts.to_vec();
    let short = Range {
        minimum: -BELOW.maximum - 1,
        maximum: BELOW.maximum,
    };
    while found.last().is_some_and(|top| !short.covers(top.range)) {
        found = split(&found, found.len() + 1);
    }
    found
}
