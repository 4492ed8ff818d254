//! What stands out from the ground, as connected things, and which of them is the strip.

use ieap_domain::words::in_a_row;

use super::Side;
use super::gray::Gray;
use super::ground::Ground;
use super::refusal::Untraceable;

/// A thing below this many pixels is dust, whatever its shape.
const LEAST_PIXELS: usize = 24;
/// A second thing at the clamp of this share of the first one's pixels may be the strip as well.
const SECOND_SHARE: f64 = 0.25;

/// Marked pixels of a row, from `from` up to but not including `to`.
#[derive(Debug, Clone, Copy)]
pub struct Stretch {
    pub y: usize,
    pub from: usize,
    pub to: usize,
    thing: usize,
}

/// Marked pixels that touch each other, also at corners.
#[derive(Debug, Clone, Default)]
pub struct Thing {
    /// Number of pixels.
    pub pixels: usize,
    sum: (f64, f64),
    sides: [usize; 4],
}

impl Thing {
    /// Middle of its pixels.
    pub fn middle(&self) -> (f64, f64) {
        let n = self.pixels.max(1) as f64;
        (self.sum.0 / n, self.sum.1 / n)
    }
}

/// All things of a picture.
#[derive(Debug)]
pub struct Silhouette {
    size: (usize, usize),
    pub stretches: Vec<Stretch>,
    pub things: Vec<Thing>,
}

/// The thing that is the strip, and where it leaves the clamp.
#[derive(Debug, Clone, Copy)]
pub struct Root {
    /// Index of the thing.
    pub thing: usize,
    /// The side of the clamp.
    pub side: Side,
    /// Middle of the strip at the side.
    pub at: (f64, f64),
    /// Pixels of the side that it covers.
    pub width: f64,
}

impl Silhouette {
    /// Finds everything that stands out.
    pub fn of(gray: &Gray, ground: &Ground) -> Silhouette {
        let mut stretches: Vec<Stretch> = Vec::new();
        let mut parent: Vec<usize> = Vec::new();
        let mut marks = Vec::with_capacity(gray.width());
        let (mut above_from, mut above_to) = (0, 0);
        for y in 0..gray.height() {
            ground.mark_row(gray, y, &mut marks);
            let first = stretches.len();
            add_stretches(&marks, y, &mut stretches, &mut parent);
            join(&stretches, (above_from, above_to), first, &mut parent);
            (above_from, above_to) = (first, stretches.len());
        }
        let size = (gray.width(), gray.height());
        let things = number(&mut stretches, &mut parent, size);
        Silhouette {
            size,
            stretches,
            things,
        }
    }

    /// The strip: the largest thing at the clamp, which is found where it is not told.
    ///
    /// # Errors
    /// Nothing reaches the clamp, or it cannot be told which side or which thing is meant.
    pub fn root(&self, told: Option<Side>) -> Result<Root, Untraceable> {
        let side = match told {
            Some(side) => side,
            None => self.only_side()?,
        };
        let at = side.index();
        let mut at_clamp: Vec<usize> = (0..self.things.len())
            .filter(|&k| self.things[k].sides[at] > 0 && self.things[k].pixels >= LEAST_PIXELS)
            .collect();
        at_clamp.sort_by_key(|&k| (std::cmp::Reverse(self.things[k].pixels), k));
        let &thing = at_clamp
            .first()
            .ok_or(Untraceable::NotAtClamp { side: side.key() })?;
        if let Some(&second) = at_clamp.get(1)
            && self.things[second].pixels as f64 > SECOND_SHARE * self.things[thing].pixels as f64
        {
            return Err(self.two(thing, second));
        }
        let (from, to) = self.widest_at(thing, side);
        let middle = 0.5 * (from + to);
        let (width, height) = (self.size.0 as f64, self.size.1 as f64);
        Ok(Root {
            thing,
            side,
            at: match side {
                Side::Left => (0.0, middle),
                Side::Right => (width, middle),
                Side::Top => (middle, 0.0),
                Side::Bottom => (middle, height),
            },
            width: to - from,
        })
    }

    /// The refusal that names two things.
    pub fn two(&self, one: usize, other: usize) -> Untraceable {
        let ((x, y), (other_x, other_y)) = (self.things[one].middle(), self.things[other].middle());
        Untraceable::TwoThings {
            x,
            y,
            other_x,
            other_y,
        }
    }

    /// The only side that the largest thing reaches.
    fn only_side(&self) -> Result<Side, Untraceable> {
        let largest = self.things.iter().max_by_key(|thing| thing.pixels);
        let Some(largest) = largest.filter(|thing| thing.pixels >= LEAST_PIXELS) else {
            return Err(Untraceable::Empty {
                contrast: 0.0,
                noise: 0.0,
            });
        };
        let reached: Vec<Side> = Side::ALL
            .into_iter()
            .filter(|side| largest.sides[side.index()] > 0)
            .collect();
        match reached[..] {
            [side] => Ok(side),
            [] => {
                let (x, y) = largest.middle();
                Err(Untraceable::NoSide { x, y })
            }
            _ => Err(Untraceable::SeveralSides {
                sides: in_a_row(&reached.iter().map(|side| side.key()).collect::<Vec<_>>()),
            }),
        }
    }

    /// The longest stretch of a side that a thing covers.
    fn widest_at(&self, thing: usize, side: Side) -> (f64, f64) {
        let of_thing = self.stretches.iter().filter(|s| s.thing == thing);
        let mut covered: Vec<(usize, usize)> = match side {
            Side::Top | Side::Bottom => {
                let row = if side == Side::Top { 0 } else { self.size.1 - 1 };
                of_thing.filter(|s| s.y == row).map(|s| (s.from, s.to)).collect()
            }
            Side::Left => of_thing.filter(|s| s.from == 0).map(|s| (s.y, s.y + 1)).collect(),
            Side::Right => {
                let width = self.size.0;
                of_thing
                    .filter(|s| s.to == width)
                    .map(|s| (s.y, s.y + 1))
                    .collect()
            }
        };
        covered.sort_unstable();
        let mut best = (0, 0);
        let mut now: (usize, usize) = (0, 0);
        for (from, to) in covered {
            now = if from <= now.1 && now.1 > 0 {
                (now.0, to.max(now.1))
            } else {
                (from, to)
            };
            if now.1 - now.0 > best.1 - best.0 {
                best = now;
            }
        }
        (best.0 as f64, best.1 as f64)
    }
}

fn add_stretches(marks: &[bool], y: usize, stretches: &mut Vec<Stretch>, parent: &mut Vec<usize>) {
    let mut x = 0;
    while let Some(skip) = marks[x..].iter().position(|mark| *mark) {
        let from = x + skip;
        let to = marks[from..]
            .iter()
            .position(|mark| !mark)
            .map_or(marks.len(), |length| from + length);
        let thing = parent.len();
        parent.push(thing);
        stretches.push(Stretch { y, from, to, thing });
        x = to;
    }
}

fn root_of(parent: &mut [usize], mut k: usize) -> usize {
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}

/// Joins the stretches of a row, from `first` on, with those above that they touch.
fn join(stretches: &[Stretch], above: (usize, usize), first: usize, parent: &mut [usize]) {
    let mut up = above.0;
    for below in &stretches[first..] {
        while up < above.1 && stretches[up].to < below.from {
            up += 1;
        }
        let mut at = up;
        while at < above.1 && stretches[at].from <= below.to {
            let (a, b) = (root_of(parent, stretches[at].thing), root_of(parent, below.thing));
            parent[a.max(b)] = a.min(b);
            at += 1;
        }
    }
}

/// Numbers the things in the order in which they appear, and sums them up.
fn number(stretches: &mut [Stretch], parent: &mut [usize], size: (usize, usize)) -> Vec<Thing> {
    let mut number_of: Vec<Option<usize>> = vec![None; parent.len()];
    let mut things: Vec<Thing> = Vec::new();
    for stretch in stretches {
        let root = root_of(parent, stretch.thing);
        let thing = *number_of[root].get_or_insert_with(|| {
            things.push(Thing::default());
            things.len() - 1
        });
        stretch.thing = thing;
        let (thing, n) = (&mut things[thing], (stretch.to - stretch.from) as f64);
        thing.pixels += stretch.to - stretch.from;
        thing.sum.0 += n * 0.5 * (stretch.from + stretch.to) as f64;
        thing.sum.1 += n * (stretch.y as f64 + 0.5);
        let reached = [
            stretch.from == 0,
            stretch.to == size.0,
            stretch.y == 0,
            stretch.y + 1 == size.1,
        ];
        for (side, reached) in thing.sides.iter_mut().zip(reached) {
            *side += usize::from(reached);
        }
    }
    things
}

impl Stretch {
    /// Index of the thing that it belongs to.
    pub fn thing(&self) -> usize {
        self.thing
    }
}
