//! How large a lens file may be. What is larger is refused before anything is computed from it: no real lens comes near
//! these limits, and a file from elsewhere must not keep its reader busy.

/// The most bytes of a lens file, 1 MiB. Real ones have a few thousand.
pub const MAX_FILE_BYTES: u64 = 1 << 20;

/// The most interfaces of a lens, and the most glasses that a lens file defines.
pub const MAX_INTERFACES: usize = 1000;

/// The most bytes of a lens file's name with its directories.
pub const MAX_PATH_BYTES: usize = 4096;

/// The most bytes of a lens's name (of a file: its name without the directories) and of a glass's.
pub const MAX_NAME_BYTES: usize = 255;

/// The most bytes of a glass catalogue, and of all that stand beside a lens file, 8 MiB. The largest makers' have one or two.
pub const MAX_CATALOG_BYTES: u64 = 8 << 20;

/// The most glasses of a catalogue, and of all that stand beside a lens file. All makers together have some 5,000.
pub const MAX_CATALOG_GLASSES: usize = 20_000;

/// The most catalogues that are looked into beside a lens file.
pub const MAX_CATALOGS: usize = 64;

/// The most bytes of a glass in a catalogue. Real ones have three thousand, most of it transmittances.
pub const MAX_GLASS_BYTES: usize = 1 << 14;

/// The most positions of a lens's moving groups.
pub const MAX_POSITIONS: usize = 100;
