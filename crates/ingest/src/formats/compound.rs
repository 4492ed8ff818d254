//! Compound files, the containers of .xls, walked here and written anew for the library that reads them: a chain of
//! sectors that leads back into itself would keep it busy until the memory is full.
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
    if entries.iter().any(|entry| entry.name == "EncryptedPackage") {
        return Err("it is protected by a password");
    }
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
                if tables.clone().count() > self.bytes.len() / self.sector_bytes {
                    return Err("its table of sectors is larger than the file");
                }
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

/// Most bytes of a stream that [`around`] takes: the header names that many tables of sectors.
pub const MOST_AROUND: u64 = 400 << 20;

/// A compound file that holds this stream alone, of at most [`MOST_AROUND`] bytes.
pub fn around(name: &str, stream: &[u8]) -> Vec<u8> {
    const SECTOR: usize = 4096;
    const IDS: usize = SECTOR / 4;
    const TABLE: u32 = 0xFFFF_FFFD;
    let is_small = (stream.len() as u64) < SMALL_BELOW;
    let of_stream = stream.len().div_ceil(SECTOR);
    // Tables, the folder, the table of small sectors, the stream.
    let before = 1 + usize::from(is_small);
    let tables = (1..)
        .find(|tables| tables * IDS >= tables + before + of_stream)
        .unwrap_or(1);
    let first = (tables + before) as u32;
    let mut file = b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1".to_vec();
    file.resize(SECTOR, 0);
    for (at, short) in [(24, 0x3E), (26, 3), (28, 0xFFFE), (30, 12), (32, 6)] {
        file[at..at + 2].copy_from_slice(&u16::to_le_bytes(short));
    }
    let small_table = if is_small { tables as u32 + 1 } else { END_OF_CHAIN };
    let mut put = |at: usize, word: u32| file[at..at + 4].copy_from_slice(&word.to_le_bytes());
    put(44, tables as u32);
    put(48, tables as u32);
    put(56, SMALL_BELOW as u32);
    put(60, small_table);
    put(64, u32::from(is_small));
    put(68, END_OF_CHAIN);
    (0..109).for_each(|k| put(76 + 4 * k, if k < tables { k as u32 } else { u32::MAX }));
    let chain = |from: u32, count: usize| {
        (1..=count as u32).map(move |k| if k < count as u32 { from + k } else { END_OF_CHAIN })
    };
    let mut next = vec![TABLE; tables];
    next.resize(tables + before, END_OF_CHAIN);
    next.extend(chain(first, of_stream));
    next.resize(tables * IDS, u32::MAX);
    file.extend(next.iter().flat_map(|id| id.to_le_bytes()));
    let small_sectors = stream.len().div_ceil(SMALL_SECTOR);
    let small_bytes = (small_sectors * SMALL_SECTOR) as u32;
    let (root, own) = if is_small {
        let own = if stream.is_empty() { END_OF_CHAIN } else { 0 };
        ((first, small_bytes), own)
    } else {
        ((END_OF_CHAIN, 0), first)
    };
    let mut folder = entry("Root Entry", 5, root.0, root.1);
    folder.extend(entry(name, 2, own, stream.len() as u32));
    folder.resize(SECTOR, 0);
    file.extend(folder);
    if is_small {
        let mut table: Vec<u32> = chain(0, small_sectors).collect();
        table.resize(IDS, u32::MAX);
        file.extend(table.iter().flat_map(|id| id.to_le_bytes()));
    }
    file.extend_from_slice(stream);
    file.resize(file.len().next_multiple_of(SECTOR), 0);
    file
}

/// An entry of a folder.
fn entry(name: &str, kind: u8, start: u32, length: u32) -> Vec<u8> {
    let mut entry: Vec<u8> = name.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let name_bytes = entry.len() as u16 + 2;
    entry.resize(128, 0);
    entry[64..66].copy_from_slice(&name_bytes.to_le_bytes());
    entry[66] = kind;
    entry[68..80].fill(0xFF);
    entry[116..120].copy_from_slice(&start.to_le_bytes());
    entry[120..124].copy_from_slice(&length.to_le_bytes());
    entry
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_around_a_stream_is_read_from_it() {
        for length in [0, 1, 64, 65, 4095, 4096, 4097, 1 << 20, 5 << 20] {
            let content: Vec<u8> = (0..length).map(|k: u32| (k % 251) as u8).collect();
            let file = around("Workbook", &content);
            assert_eq!(stream(&file, &["workbook"]).as_ref(), Ok(&content), "{length}");
        }
    }

    /// Each word of the file that can lead on leads to each sector once: nothing takes longer than the file is long, or gives
    /// more than it holds.
    #[test]
    fn wherever_a_chain_leads_back_it_is_walked_once_around() {
        for length in [3000, 20_000] {
            let content = vec![7; length];
            let whole = around("Workbook", &content);
            let (mut refused, mut tried) = (0, 0);
            let words = (44..84)
                .chain(4096..4096 + 64)
                .chain(8192..8192 + 256)
                .chain(12_288..12_288 + 64);
            for at in words.step_by(4) {
                for target in 0..whole.len() as u32 / 4096 {
                    let mut worse = whole.clone();
                    worse[at..at + 4].copy_from_slice(&target.to_le_bytes());
                    let found = stream(&worse, &["Workbook"]);
                    refused += usize::from(found.is_err());
                    tried += 1;
                    assert!(found.is_ok_and(|found| found.len() <= whole.len()) || refused > 0);
                }
            }
            assert!(refused > 20 && refused < tried, "{refused} of {tried}");
        }
    }
}
