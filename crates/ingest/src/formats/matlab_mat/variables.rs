//! Variables of a .mat file: arrays of numbers, texts, lists of texts, and the fields of structs.

use super::elements::{Bytes, COMPRESSED, Element, INT8, INT32, MATRIX, UINT32, UTF8};
use crate::formats::error::{ReadError, escaped};

/// Length of the file's head; version and order of bytes are its last four bytes.
const HEAD: usize = 128;
/// Classes of arrays; numbers of the format.
const CELL: u32 = 1;
const STRUCT: u32 = 2;
const CHAR: u32 = 4;
const SPARSE: u32 = 5;
const FIRST_NUMERIC: u32 = 6;
const LAST_NUMERIC: u32 = 15;
const OPAQUE: u32 = 17;
/// Flag of complex numbers.
const COMPLEX: u32 = 0x0800;
/// How deep structs and cells may stand in each other.
const DEEPEST: usize = 4;
/// Most variables and fields that are read.
const MOST: usize = 10_000;
/// Bytes of a number as it is held, and of a text beside its letters.
const NUMBER_BYTES: u64 = 8;
const TEXT_BYTES: u64 = 64;

/// One variable, or one field of a struct.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// The struct that it is a field of, `data`, `data(2)` or `data.step`; empty for a variable of its own.
    pub owner: String,
    /// Its name in there.
    pub name: String,
    /// Rows, columns, and further dimensions.
    pub dimensions: Vec<usize>,
    /// What it holds.
    pub content: Content,
}

/// What a variable holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// Numbers, column by column.
    Numbers(Vec<f64>),
    /// Texts: the rows of an array of characters, or the cells of a cell array.
    Texts(Vec<String>),
    /// Something else, in words.
    NotRead(&'static str),
}

impl Variable {
    /// Its numbers where it is a vector of at least two.
    pub fn vector(&self) -> Option<&[f64]> {
        let is_vector = self.dimensions.iter().filter(|&&n| n != 1).count() == 1;
        match &self.content {
            Content::Numbers(numbers) if is_vector && numbers.len() > 1 => Some(numbers),
            _ => None,
        }
    }

    /// Its columns where it is a table of at least two rows and two columns.
    pub fn matrix(&self) -> Option<Vec<&[f64]>> {
        match (&self.content, self.dimensions.as_slice()) {
            (Content::Numbers(numbers), &[rows, columns]) if rows > 1 && columns > 1 => {
                Some(numbers.chunks_exact(rows).collect())
            }
            _ => None,
        }
    }

    /// `data.current_mA`.
    pub fn path(&self) -> String {
        if self.owner.is_empty() {
            self.name.clone()
        } else {
            format!("{}.{}", self.owner, self.name)
        }
    }

    /// `3600 x 3`.
    pub fn shape(&self) -> String {
        let sizes: Vec<String> = self.dimensions.iter().map(usize::to_string).collect();
        sizes.join(" x ")
    }
}

/// Every variable of a file; fields of structs stand among them.
///
/// # Errors
/// An element breaks off or contradicts another, or the numbers take more than `limit` bytes.
pub fn read(bytes: &[u8], limit: u64) -> Result<Vec<Variable>, ReadError> {
    let mut whole = Bytes {
        bytes,
        is_big_endian: false,
        offset: 0,
    };
    let head = bytes
        .get(..HEAD)
        .ok_or_else(|| whole.broken("the file ends within its head"))?;
    whole.is_big_endian = match &head[126..] {
        b"IM" => false,
        b"MI" => true,
        other => {
            let found = escaped(&String::from_utf8_lossy(other));
            return Err(whole.broken(&format!("the order of bytes {found}")));
        }
    };
    whole.bytes = &bytes[HEAD..];
    whole.offset = HEAD as u64;
    let mut found = Found {
        variables: Vec::new(),
        limit,
        left: limit,
    };
    let mut packed_left = limit;
    while let Some(element) = whole.next()? {
        match element.kind {
            MATRIX => found.variable(element.data)?,
            COMPRESSED => {
                let unpacked = element.unpacked(packed_left)?;
                packed_left -= unpacked.len() as u64;
                let mut inside = Bytes {
                    bytes: &unpacked,
                    ..element.data
                };
                found.variable(inside.expect(&[MATRIX], "an array")?.data)?;
            }
            other => return Err(whole.broken(&format!("an element of type {other} in place of a variable"))),
        }
    }
    Ok(found.variables)
}

/// An array without its data.
struct Head {
    class: u32,
    is_complex: bool,
    dimensions: Vec<usize>,
    name: String,
}

/// Where an array stands: in which struct, under which name, how deep.
#[derive(Clone, Copy)]
struct Place<'a> {
    owner: &'a str,
    name: &'a str,
    depth: usize,
}

/// What was found so far.
struct Found {
    variables: Vec<Variable>,
    /// Most bytes that all numbers and texts together may take, and how many are left.
    limit: u64,
    left: u64,
}

impl Found {
    /// A variable of the file. Without a name it is what MATLAB keeps for its own objects.
    fn variable(&mut self, mut data: Bytes<'_>) -> Result<(), ReadError> {
        let head = head(&mut data)?;
        let name = head.name.clone();
        let place = Place {
            owner: "",
            name: &name,
            depth: 0,
        };
        if name.is_empty() {
            Ok(())
        } else {
            self.array(head, data, place)
        }
    }

    fn array(&mut self, head: Head, data: Bytes<'_>, place: Place<'_>) -> Result<(), ReadError> {
        if self.variables.len() >= MOST {
            return Err(data.broken("more variables than any measurement has"));
        }
        let content = match head.class {
            STRUCT if place.depth < DEEPEST => return self.structs(&head, data, place),
            STRUCT => Content::NotRead("a struct in a struct in a struct"),
            CELL => self.cells(data, &head)?,
            CHAR => Content::Texts(self.texts(data, &head.dimensions)?),
            FIRST_NUMERIC..=LAST_NUMERIC if head.is_complex => {
                Content::NotRead("complex numbers; save real(...) and imag(...) beside it")
            }
            FIRST_NUMERIC..=LAST_NUMERIC => Content::Numbers(self.numbers(data, &head.dimensions)?),
            SPARSE => Content::NotRead("a sparse matrix"),
            OPAQUE => Content::NotRead(
                "an object of MATLAB (table, datetime, string); save table2struct(t, 'ToScalar', true) in its place",
            ),
            _ => Content::NotRead("an object of MATLAB"),
        };
        self.variables.push(Variable {
            owner: place.owner.to_owned(),
            name: place.name.to_owned(),
            dimensions: head.dimensions,
            content,
        });
        Ok(())
    }

    fn numbers(&mut self, mut data: Bytes<'_>, dimensions: &[usize]) -> Result<Vec<f64>, ReadError> {
        let here = data;
        let element = data.next()?;
        self.take(element.map_or(0, |element| element.count()) as u64 * NUMBER_BYTES)?;
        let numbers = match element {
            Some(element) => element.numbers()?,
            None => Vec::new(),
        };
        if product(dimensions) == Some(numbers.len()) {
            Ok(numbers)
        } else {
            let found = format!("{} numbers in an array of {dimensions:?}", numbers.len());
            Err(here.broken(&found))
        }
    }

    /// Takes room for numbers or texts.
    fn take(&mut self, bytes: u64) -> Result<(), ReadError> {
        self.left = self.left.checked_sub(bytes).ok_or_else(|| ReadError::TooLarge {
            what: "the .mat file".to_owned(),
            found: self.limit - self.left + bytes,
            limit: self.limit,
        })?;
        Ok(())
    }

    /// The texts of a cell array that holds nothing else.
    fn cells(&mut self, mut data: Bytes<'_>, head: &Head) -> Result<Content, ReadError> {
        let mut found = Vec::new();
        for _ in 0..product(&head.dimensions).unwrap_or(usize::MAX) {
            let mut cell = data.expect(&[MATRIX], "a cell")?.data;
            let own = if cell.bytes.is_empty() {
                None
            } else {
                Some(self::head(&mut cell)?)
            };
            match own.filter(|own| own.class == CHAR) {
                Some(own) => found.push(self.texts(cell, &own.dimensions)?.join(" ")),
                None => return Ok(Content::NotRead("a cell array of other things than texts")),
            }
        }
        Ok(Content::Texts(found))
    }

    /// The rows of an array of characters, without the blanks that fill them up; it is stored column by column.
    fn texts(&mut self, mut data: Bytes<'_>, dimensions: &[usize]) -> Result<Vec<String>, ReadError> {
        let here = data;
        let element = data.next()?;
        let rows = dimensions.first().copied().unwrap_or(0);
        let letters = element.map_or(0, |element| element.data.bytes.len());
        self.take(letters as u64 * NUMBER_BYTES + rows.min(letters) as u64 * TEXT_BYTES)?;
        let units = match element {
            Some(element) => characters(&element)?,
            None => Vec::new(),
        };
        if product(dimensions) != Some(units.len()) {
            // UTF-8 may have more bytes than there are characters: a single row needs no count.
            return match rows {
                1 => Ok(vec![String::from_utf16_lossy(&units)]),
                _ => Err(here.broken(&format!("{} characters in {dimensions:?}", units.len()))),
            };
        }
        let row = |row: usize| {
            let units: Vec<u16> = units.iter().skip(row).step_by(rows).copied().collect();
            String::from_utf16_lossy(&units).trim_end().to_owned()
        };
        Ok((0..rows.min(units.len())).map(row).collect())
    }

    /// The fields of a struct, or of each struct of a list.
    fn structs(&mut self, head: &Head, mut data: Bytes<'_>, place: Place<'_>) -> Result<(), ReadError> {
        let here = data;
        let width = data.expect(&[INT32], "the length of field names")?.numbers()?;
        let width = width.first().map_or(0.0, |&width| width) as usize;
        let names = data.expect(&[INT8], "the names of fields")?.data;
        if width == 0 && !names.bytes.is_empty() {
            return Err(names.broken("field names without a length"));
        }
        if names.bytes.len() / width.max(1) > MOST {
            return Err(names.broken("more fields than any measurement has"));
        }
        let names: Vec<String> = names.bytes.chunks(width.max(1)).map(until_zero).collect();
        let own = if place.owner.is_empty() {
            place.name.to_owned()
        } else {
            format!("{}.{}", place.owner, place.name)
        };
        let count = product(&head.dimensions).ok_or_else(|| here.broken("a list of structs without end"))?;
        for number in 1..=if names.is_empty() { 0 } else { count } {
            let owner = match count {
                1 => own.clone(),
                _ => format!("{own}({number})"),
            };
            for name in &names {
                let mut field = data.expect(&[MATRIX], "a field")?.data;
                // A field that was never set has no parts.
                if field.bytes.is_empty() {
                    continue;
                }
                let head = self::head(&mut field)?;
                let place = Place {
                    owner: &owner,
                    name,
                    depth: place.depth + 1,
                };
                self.array(head, field, place)?;
            }
        }
        Ok(())
    }
}

/// What stands before the data of an array.
fn head(data: &mut Bytes<'_>) -> Result<Head, ReadError> {
    let flags = data.expect(&[UINT32], "the flags of an array")?.numbers()?;
    let flags = flags.first().map_or(0, |&flags| flags as u32);
    let class = flags & 0xff;
    let dimensions = match class {
        OPAQUE => Vec::new(),
        _ => data.expect(&[INT32], "the dimensions of an array")?.numbers()?,
    };
    let name = data.expect(&[INT8, UTF8], "the name of an array")?;
    Ok(Head {
        class,
        is_complex: flags & COMPLEX != 0,
        dimensions: dimensions
            .into_iter()
            .map(|size| size.max(0.0) as usize)
            .collect(),
        name: String::from_utf8_lossy(name.data.bytes).into_owned(),
    })
}

/// Characters in UTF-16, whatever they are stored in.
fn characters(element: &Element<'_>) -> Result<Vec<u16>, ReadError> {
    if element.kind == INT8 || element.kind == UTF8 {
        let text = String::from_utf8_lossy(element.data.bytes);
        return Ok(text.encode_utf16().collect());
    }
    Ok(element.numbers()?.into_iter().map(|unit| unit as u16).collect())
}

fn product(dimensions: &[usize]) -> Option<usize> {
    dimensions
        .iter()
        .try_fold(1usize, |product, &size| product.checked_mul(size))
}

fn until_zero(name: &[u8]) -> String {
    let end = name.iter().position(|&byte| byte == 0).unwrap_or(name.len());
    String::from_utf8_lossy(&name[..end]).into_owned()
}
