//! Sums of products by class of rows.

use super::matrices::add;
use super::panels::Panels;
use super::tiles::add_chosen;
use std::collections::BTreeMap;

/// Rows that count in the same sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Class {
    /// Whether they begin series.
    pub begins: bool,
    /// Their block, or their cell.
    pub own: u32,
    /// That of the row that follows in the series.
    pub next: Option<u32>,
}

/// Sums by class and kind of row vector; of rows that begin a series the first kind alone.
pub(crate) type ClassSums = BTreeMap<Class, Vec<Vec<f64>>>;

/// Adds the sums of the span that follows.
pub(crate) fn join(all: &mut ClassSums, more: ClassSums) {
    for (class, kinds) in more {
        let Some(own) = all.get_mut(&class) else {
            all.insert(class, kinds);
            continue;
        };
        for (sums, more) in own.iter_mut().zip(&kinds) {
            add(sums, more);
        }
    }
}

/// Rows of a block by class.
#[derive(Default)]
pub(crate) struct ClassLists(Vec<(Class, Vec<u32>)>);

impl ClassLists {
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    pub(crate) fn push(&mut self, class: Class, row: u32) {
        match self.0.iter_mut().rev().find(|(other, _)| *other == class) {
            Some((_, rows)) => rows.push(row),
            None => self.0.push((class, vec![row])),
        }
    }

    /// Adds the products of one kind to the sums, of which there are so many a class.
    pub(crate) fn add(
        &self,
        panels: &Panels,
        kind: usize,
        kinds: usize,
        length: usize,
        sums: &mut ClassSums,
    ) {
        let rows = panels.rows();
        let with = |(class, _): &&(Class, Vec<u32>)| kind == 0 || !class.begins;
        for (class, chosen) in self.0.iter().filter(with) {
            let kinds = if class.begins { 1 } else { kinds };
            let own = sums
                .entry(*class)
                .or_insert_with(|| vec![vec![0.0; length]; kinds]);
            add_chosen(rows, chosen, panels.width(), &mut own[kind]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use echocal_core::batch::Line;

    const fn class(begins: bool, own: u32) -> Class {
        Class {
            begins,
            own,
            next: None,
        }
    }

    #[test]
    fn rows_count_in_the_sums_of_their_class() {
        let mut lines = [Line::of(0.0), Line::of(1.0)];
        lines[0].0[..4].copy_from_slice(&[2.0, 3.0, 5.0, 7.0]);
        let mut panels = Panels::new(8);
        panels.fill(&lines, 4);
        panels.leave_out_zeros(4);
        let mut lists = ClassLists::default();
        for (row, class) in [
            (1, class(true, 0)),
            (2, class(false, 0)),
            (3, class(false, 1)),
        ] {
            lists.push(class, row);
        }
        lists.push(class(false, 0), 4);
        let mut sums = ClassSums::new();
        lists.add(&panels, 0, 2, 64, &mut sums);
        lists.add(&panels, 1, 2, 64, &mut sums);
        let square = |class: Class, kind: usize| sums[&class][kind][0];
        assert_eq!(square(class(false, 0), 0), 9.0 + 49.0);
        assert_eq!(square(class(false, 0), 1), 9.0 + 49.0);
        assert_eq!(square(class(false, 1), 0), 25.0);
        assert_eq!(sums[&class(true, 0)].len(), 1);
        assert_eq!(sums[&class(true, 0)][0][1], 2.0);
        let more = sums.clone();
        join(&mut sums, more);
        assert_eq!(sums[&class(false, 0)][0][0], 2.0 * 58.0);
    }
}
