//! What decides whether two files hold the same readings: every number with its unit and where it comes from.

/// Readings that must step by more than the printed digits. Chosen: a record that rests, or is printed with two digits, is like
/// many others.
pub(super) const FEWEST_TELLING: usize = 8;
/// Readings of a part by which its place in the whole is found. Chosen.
pub(super) const ANCHOR_READINGS: usize = 3;
/// Places that are tried. Chosen.
pub(super) const MOST_PLACES: usize = 16;

/// Marks of each kind: a part that holds a tenth of a record shares about six of them with it.
pub(super) const MARKS: usize = 64;
/// Marks of one kind that two records must share to be looked at: half of those of such a part.
pub(super) const SHARED_MARKS: u16 = 3;
/// Digits of values that go into a coarse mark: no export prints fewer.
pub(super) const COARSE_DIGITS: i32 = 3;
/// Digits of values that go into a fine mark: repeats differ in the fifth digit.
pub(super) const FINE_DIGITS: i32 = 5;
/// Digits of times, which go on in step with the rows. Chosen.
pub(super) const TIME_DIGITS: i32 = 4;
/// Most digits of a number that are not the noise of a conversion. Chosen.
pub(super) const MOST_DIGITS: i32 = 12;
/// Numbers that the digits of a channel are told from. Chosen.
pub(super) const NUMBERS_ASKED: usize = 2000;
