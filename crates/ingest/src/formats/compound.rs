//! Compound files, the containers of .xls, walked before the library that reads them does: a chain of sectors that
//! leads back into itself would keep it busy until the memory is full.
//!
//! After Microsoft's [MS-CFB]: a header, sectors of 512 or 4096 bytes, a table that gives the sector after each, and a
//! folder of streams; streams below 4096 bytes lie in a stream of their own with sectors of 64 bytes.

/// First number of a sector that is none; the end of a chain is among them.
const NO_SECTOR: u32 = 0xFFFF_FFFC;
const END_OF_CHAIN: u32 = 0xFFFF_FFFE;
/// Streams below this many bytes lie in small sectors.
const SMALL_BELOW: u64 = 4096;
const SMALL_SECTOR: usize = 64;

/// A compound file.
struct Compound<'a> {
    bytes: &'a [u8],
    sector_bytes: usize,
    /// The sector after each.
    next: Vec<u32>,
}

/// A stream of the folder.
struct Entry {
    name: String,
    start: u32,
    length: u64,
}

/// The bytes of the first of the named streams that is there (letters of any size).
///
/// # Errors
/// What is wrong with the container, in words.
pub fn stream(bytes: &[u8], names: &[&str]) -> Result<Vec<u8>, &'static str> {
    let header = bytes.get(..512).ok_or("the file ends in its header")?;
    let sector_bytes = match u16::from_le_bytes([header[30], header[31]]) {
        9 => 512,
        12 => 4096,
        _ => return Err("its sectors have a size that does not exist"),
    };
    let mut file = Compound {
        bytes,
        sector_bytes,
        next: Vec::new(),
    };
    file.next = file.table(header)?;
    let folder = file.chain(word(header, 48), u64::MAX)?;
    let entries: Vec<Entry> = folder
        .chunks_exact(128)
        .map(|entry| Entry::of(entry, sector_bytes))
        .collect();
    let small = match word(header, 64) {
        0 => None,
        _ => {
            let root = entries.first().ok_or("its folder is empty")?;
            let table_bytes = u64::from(word(header, 64)) * sector_bytes as u64;
            let table = file.chain(word(header, 60), table_bytes)?;
            Some((file.chain(root.start, root.length)?, words(&table)))
        }
    };
    let named = |name: &&str| entries.iter().find(|entry| entry.name.eq_ignore_ascii_case(name));
    let entry = names.iter().find_map(named).ok_or("it holds no workbook")?;
    match (entry.length < SMALL_BELOW, small) {
        (false, _) => file.chain(entry.start, entry.length),
        (true, Some((sectors, next))) => chain((&sectors, 0), SMALL_SECTOR, &next, entry.start, entry.length),
        (true, None) => Err("a short stream lies nowhere"),
    }
}

impl Compound<'_> {
    /// The table of sectors: its first 109 sectors are named in the header, the others in sectors of such names.
    fn table(&self, header: &[u8]) -> Result<Vec<u32>, &'static str> {
        let mut ids = words(&header[76..]);
        let mut list = word(header, 68);
        for _ in 0..=self.bytes.len() / self.sector_bytes {
            if list >= NO_SECTOR {
                let tables = ids.iter().filter(|id| **id < NO_SECTOR);
                let sectors: Option<Vec<Vec<u32>>> = tables.map(|id| self.sector(*id).map(words)).collect();
                return Ok(sectors
                    .ok_or("its table of sectors lies beyond its end")?
                    .concat());
            }
            ids.extend(words(
                self.sector(list)
                    .ok_or("its table of sectors lies beyond its end")?,
            ));
            list = ids.pop().unwrap_or(END_OF_CHAIN);
        }
        Err("its table of sectors leads back into itself")
    }

    fn sector(&self, id: u32) -> Option<&[u8]> {
        sector(self.bytes, self.sector_bytes, self.sector_bytes, id)
    }

    fn chain(&self, start: u32, most: u64) -> Result<Vec<u8>, &'static str> {
        let size = self.sector_bytes;
        chain((self.bytes, size), size, &self.next, start, most)
    }
}

impl Entry {
    fn of(entry: &[u8], sector_bytes: usize) -> Entry {
        let letters = entry[..64]
            .chunks_exact(2)
            .map(|pair| u16::from_le_bytes([pair[0], pair[1]]));
        let name: Vec<u16> = letters.take_while(|letter| *letter != 0).collect();
        let high = if sector_bytes == 512 { 0 } else { word(entry, 124) };
        Entry {
            name: String::from_utf16_lossy(&name),
            start: word(entry, 116),
            length: u64::from(high) << 32 | u64::from(word(entry, 120)),
        }
    }
}

/// A sector, the last of which may be short; sectors begin `from` bytes into `bytes`.
fn sector(bytes: &[u8], from: usize, size: usize, id: u32) -> Option<&[u8]> {
    let start = (id as usize).checked_mul(size)?.checked_add(from)?;
    bytes.get(start..bytes.len().min(start.checked_add(size)?))
}

/// The first `most` bytes of a chain of sectors; these begin `from` bytes into `bytes`.
fn chain(
    (bytes, from): (&[u8], usize),
    size: usize,
    next: &[u32],
    start: u32,
    most: u64,
) -> Result<Vec<u8>, &'static str> {
    let mut found = Vec::new();
    let mut id = start;
    for _ in 0..=bytes.len() / size {
        if id == END_OF_CHAIN || found.len() as u64 >= most {
            found.truncate(usize::try_from(most).unwrap_or(usize::MAX));
            return Ok(found);
        }
        found.extend_from_slice(sector(bytes, from, size, id).ok_or("a stream leads beyond its end")?);
        id = *next
            .get(id as usize)
            .ok_or("a stream leads beyond its table of sectors")?;
    }
    Err("a stream leads back into itself")
}

fn word(bytes: &[u8], at: usize) -> u32 {
    bytes
        .get(at..at + 4)
        .map_or(0, |four| u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
}

fn words(bytes: &[u8]) -> Vec<u32> {
    let fours = bytes.chunks_exact(4);
    fours
        .map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
        .collect()
}
