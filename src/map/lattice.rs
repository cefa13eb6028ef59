//! Lines through the plane of a map in both parameters, on which waves are followed until nothing new is
//! found.
//!
//! A row of a map knows the slip-stick waves that exist on it. Others are connected with slip-stick waves of
//! other rows: beyond the fold where the fast and the slow wave meet, for example, there are waves that
//! separate. A few rows and columns are followed from their own slip-stick waves; where they cross, each is
//! followed from the waves of the other as well, until there is none that it does not know. The waves on the
//! columns are what every row is then followed from. So a row depends on the problem alone, whoever computes it, and both
//! orders of the parameters find the same waves.

use rayon::prelude::*;

use super::cell::Missing;
use super::line::{Gap, Hit, MapLine, Met};
use super::plane::MapPlane;
use crate::branch::run::RunError;
use crate::problem::{Map, Problem};

/// Most rows, and most columns, of the lattice: a tenth of the lines of a fine map.
const LINES: usize = 16;

/// Most waves on the columns, of one passage: they are kept in memory.
const MOST_WAVES: usize = 200_000;

/// A wave on a line, and the number of the start it is connected with.
type Wave = (Hit, usize);

/// A line of the lattice and what is known of it.
struct Strand<'a> {
    line: MapLine<'a>,
    /// Number of the row or column.
    place: usize,
    waves: Vec<Wave>,
    /// How many of them the strands that cross it have been told.
    told: usize,
    gaps: Vec<(Gap, usize)>,
}

impl Strand<'_> {
    fn knows(&self, hit: &Hit) -> bool {
        self.waves.iter().any(|(other, _)| hit.is(other))
    }

    /// Takes over what a branch has met.
    fn add(&mut self, met: Met, start: usize) {
        for hit in met.hits {
            if !self.knows(&hit) {
                self.waves.push((hit, start));
            }
        }
        self.gaps
            .extend(met.gaps.into_iter().map(|gap| (gap, start)));
    }

    /// Follows the branches through waves that are not known yet.
    fn follow(&mut self, seeds: &[Wave]) -> Result<(), RunError> {
        for (seed, start) in seeds {
            if !self.knows(seed) {
                let met = self.line.follow_wave(seed, &|hit| self.knows(hit))?;
                self.add(met, *start);
            }
        }
        Ok(())
    }
}

/// The waves on a few lines through the plane.
pub(super) struct Lattice<'a> {
    rows: Vec<Strand<'a>>,
    columns: Vec<Strand<'a>>,
}

impl<'a> Lattice<'a> {
    /// Follows all lines. `watch` is told the number of waves found so far.
    ///
    /// # Errors
    /// When the problem asks for something that no line can have.
    pub fn new(
        problem: &'a Problem,
        map: &Map,
        plane: &MapPlane,
        watch: &mut dyn FnMut(usize),
    ) -> Result<Lattice<'a>, RunError> {
        let Some([firsts, seconds]) = plane.axes() else {
            return Ok(Lattice {
                rows: Vec::new(),
                columns: Vec::new(),
            });
        };
        let strand = |along, across, values, place| Strand {
            line: MapLine {
                problem,
                along,
                across,
                values,
                request: None,
            },
            place,
            waves: Vec::new(),
            told: 0,
            gaps: Vec::new(),
        };
        let most = LINES.min((MOST_WAVES / firsts.len()).max(2));
        let columns = chosen(seconds.len(), most);
        let met: Vec<f64> = columns.iter().map(|&column| seconds[column]).collect();
        let row = |row: usize| {
            let across = (map.first.parameter, firsts[row]);
            strand(map.second, across, met.clone(), row)
        };
        let column = |column: usize| {
            let across = (map.second.parameter, seconds[column]);
            strand(map.first, across, firsts.clone(), column)
        };
        let mut lattice = Lattice {
            rows: chosen(firsts.len(), LINES).into_iter().map(row).collect(),
            columns: columns.into_iter().map(column).collect(),
        };
        lattice.all().try_for_each(|strand| {
            for (number, start) in map.starts.0.iter().enumerate() {
                let met = strand.line.follow_start(start)?;
                strand.add(met, number);
            }
            Ok::<(), RunError>(())
        })?;
        while lattice.cross(watch)? {}
        for column in &mut lattice.columns {
            column.waves.sort_by_key(|(hit, _)| hit.index);
        }
        Ok(lattice)
    }

    fn all(&mut self) -> impl ParallelIterator<Item = &mut Strand<'a>> {
        self.rows.par_iter_mut().chain(self.columns.par_iter_mut())
    }

    /// Follows every line from the waves that the lines crossing it have found since the last time.
    /// Returns whether there were any.
    fn cross(&mut self, watch: &mut dyn FnMut(usize)) -> Result<bool, RunError> {
        let place = |strands: &[Strand], place: usize| {
            strands.binary_search_by_key(&place, |strand| strand.place)
        };
        let at = |(hit, start): &Wave, index| {
            let hit = Hit {
                index,
                ..hit.clone()
            };
            (hit, *start)
        };
        let mut of_rows: Vec<Vec<Wave>> = vec![Vec::new(); self.rows.len()];
        let mut of_columns: Vec<Vec<Wave>> = vec![Vec::new(); self.columns.len()];
        // a row meets the columns of the lattice, a column meets all rows
        for row in &self.rows {
            for wave in &row.waves[row.told..] {
                of_columns[wave.0.index].push(at(wave, row.place));
            }
        }
        for (number, column) in self.columns.iter().enumerate() {
            for wave in &column.waves[column.told..] {
                if let Ok(row) = place(&self.rows, wave.0.index) {
                    of_rows[row].push(at(wave, number));
                }
            }
        }
        let seeds: Vec<Vec<Wave>> = of_rows.into_iter().chain(of_columns).collect();
        let strands = self.rows.iter_mut().chain(&mut self.columns);
        let mut known = 0;
        for strand in strands {
            strand.told = strand.waves.len();
            known += strand.told;
        }
        watch(known);
        let work: Vec<_> = self
            .rows
            .iter_mut()
            .chain(&mut self.columns)
            .zip(&seeds)
            .collect();
        work.into_par_iter()
            .try_for_each(|(strand, seeds)| strand.follow(seeds))?;
        let mut strands = self.rows.iter().chain(&self.columns);
        Ok(strands.any(|strand| strand.waves.len() > strand.told))
    }

    /// The waves at a row of the map, with the numbers of their columns there.
    pub fn on_row(&self, row: usize) -> impl Iterator<Item = Wave> {
        self.columns.iter().flat_map(move |column| {
            let from = column.waves.partition_point(|(hit, _)| hit.index < row);
            let here = column.waves[from..].iter();
            let here = here.take_while(move |(hit, _)| hit.index == row);
            here.map(|(hit, start)| {
                let hit = Hit {
                    index: column.place,
                    ..hit.clone()
                };
                (hit, *start)
            })
        })
    }

    /// Why the column next to a place did not come to it, if that failed; `first` is the value of the
    /// first parameter.
    pub fn gap(&self, column: usize, first: f64, start: usize) -> Option<Missing> {
        let nearest = |strand: &&Strand| strand.place.abs_diff(column);
        let strand = self.columns.iter().min_by_key(nearest)?;
        let mut gaps = strand.gaps.iter().filter(|(_, of)| *of == start);
        gaps.find_map(|(gap, _)| gap.hides(first))
    }
}

/// Equidistant ones of `count` numbers, both ends among them.
fn chosen(count: usize, most: usize) -> Vec<usize> {
    let lines = count.min(most);
    let step = |number: usize| (number * (count - 1) + (lines - 1) / 2) / (lines - 1);
    (0..lines).map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::chosen;

    #[test]
    fn lines_are_spread_from_end_to_end() {
        assert_eq!(chosen(5, 16), [0, 1, 2, 3, 4]);
        assert_eq!(chosen(2, 2), [0, 1]);
        let some = chosen(200, 16);
        assert_eq!((some[0], some[15], some.len()), (0, 199, 16));
        assert!(
            some.windows(2)
                .all(|pair| (13..=14).contains(&(pair[1] - pair[0])))
        );
    }
}
