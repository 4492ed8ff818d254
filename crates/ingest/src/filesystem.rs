//! Which file system a path lies on.

use std::io;
use std::path::Path;

/// Magic numbers of file systems whose changes made elsewhere cause no local event, and on which SQLite's
/// write-ahead log cannot work. Source: `statfs(2)` and the kernel's `include/uapi/linux/magic.h`.
const NETWORK: [(u32, &str); 15] = [
    (0x0000_6969, "NFS"),
    (0xFF53_4D42, "CIFS"),
    (0xFE53_4D42, "SMB2"),
    (0x0000_517B, "SMB"),
    (0x0000_564C, "NCP"),
    (0x6573_5546, "FUSE"),
    (0x0102_1997, "9p"),
    (0x5346_414F, "AFS"),
    (0x6B41_4653, "AFS"),
    (0x00C3_6400, "Ceph"),
    (0x7375_7245, "Coda"),
    (0x0BD0_0BD0, "Lustre"),
    (0x4750_4653, "GPFS"),
    (0x1983_0326, "BeeGFS"),
    (0x786F_4256, "VirtualBox shared folder"),
];

/// Name of the network (or FUSE) file system with that magic number; none for a local one.
pub fn network_name(magic: u32) -> Option<&'static str> {
    NETWORK
        .iter()
        .find(|(known, _)| *known == magic)
        .map(|(_, name)| *name)
}

/// Name of the network (or FUSE) file system that `path`, or the nearest folder above it that exists, lies
/// on; none where it is local. Outside Linux nothing is known and none is given.
///
/// # Errors
/// What the operating system says where it cannot tell.
pub fn network_kind(path: &Path) -> io::Result<Option<&'static str>> {
    let existing = path.ancestors().find(|folder| folder.exists());
    match existing {
        Some(folder) => magic(folder).map(|magic| magic.and_then(network_name)),
        // A relative path of which nothing exists starts in the current folder.
        None => magic(Path::new(".")).map(|magic| magic.and_then(network_name)),
    }
}

#[cfg(target_os = "linux")]
fn magic(path: &Path) -> io::Result<Option<u32>> {
    // The field is wider than the number on some machines and sign-extended on others: 32 bits carry it.
    Ok(Some(rustix::fs::statfs(path)?.f_type as u32))
}

#[cfg(not(target_os = "linux"))]
fn magic(_path: &Path) -> io::Result<Option<u32>> {
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn network_file_systems_are_told_from_local_ones() {
        for (magic, name) in [
            (0x6969, Some("NFS")),
            (0xFF53_4D42, Some("CIFS")),
            (0xFE53_4D42, Some("SMB2")),
            (0x6573_5546, Some("FUSE")),
            (0x0102_1997, Some("9p")),
            (0xEF53, None),      // ext2 to ext4
            (0x0102_1994, None), // tmpfs
            (0x5846_5342, None), // XFS
            (0x9123_683E, None), // Btrfs
        ] {
            assert_eq!(network_name(magic), name, "{magic:x}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn proc_is_local_also_by_a_path_that_does_not_exist() {
        assert_eq!(magic(Path::new("/proc/self")).unwrap(), Some(0x9FA0));
        assert_eq!(network_kind(Path::new("/proc/no/such/folder")).unwrap(), None);
    }
}
