//! Reads regular files up to a size limit, and writes a file whole or not at all: on a full disk, the old file
//! remains, and no part of the new file. Missing folders are made, and `-` is standard output.

use crate::failure::Failure;
use std::fs::{File, OpenOptions};
use std::io::{self, Read as _, Write};
use std::path::Path;

/// Whether a path is the name of standard output.
pub fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Opens a file and refuses any that is not regular: a pipe could block, and a device may have no end.
///
/// # Errors
/// The system's error, or a file that is not regular.
pub fn open(path: &Path) -> io::Result<File> {
    let found = path.metadata()?;
    if found.is_file() {
        return File::open(path);
    }
    let what = if found.is_dir() { "a folder" } else { "a pipe or a device" };
    Err(io::Error::new(io::ErrorKind::InvalidInput, format!("it is {what}, and no file")))
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// As for [`open`], or a larger file.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, format!("it has more than {most} bytes")));
    }
    Ok(bytes)
}

/// Makes the folder of an output file. Commands call this before their work begins.
///
/// # Errors
/// The folder cannot be made; the message names it.
pub fn make_parent(file: &Path) -> Result<(), Failure> {
    match file.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        Some(folder) => make_folder(folder),
        None => Ok(()),
    }
}

/// Makes an output folder and its parents.
///
/// # Errors
/// The folder cannot be made; the message names it.
pub fn make_folder(folder: &Path) -> Result<(), Failure> {
    if folder.exists() && !folder.is_dir() {
        let name = folder.display();
        return Err(Failure::Usage(format!(
            "{name} is a file; give a folder, which is made if it is not there"
        )));
    }
    std::fs::create_dir_all(folder).map_err(|error| {
        Failure::Other(format!("cannot make the folder {}: {error}; give another path", folder.display()))
    })
}

/// Writes a file under a temporary name in the same folder, then renames it. A path that is not a regular file, such
/// as a pipe or a device, is written directly; a symbolic link remains a link. A missing folder is made.
///
/// # Errors
/// The system's error. In that case, an existing file is unchanged, and no temporary file remains.
pub fn save(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if is_stdout(path) {
        let mut stdout = io::stdout().lock();
        return stdout.write_all(bytes).and_then(|()| stdout.flush());
    }
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let old = match path.metadata() {
        Ok(found) if !found.is_file() => return File::options().write(true).open(&path)?.write_all(bytes),
        // A user without write permission for a file must not replace it.
        Ok(_) => Some(OpenOptions::new().append(true).open(&path)?.metadata()?.permissions()),
        Err(_) => None,
    };
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(directory)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".realistic-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(directory)?;
    file.write_all(bytes)?;
    if let Some(permissions) = old {
        file.as_file().set_permissions(permissions)?;
    }
    // Some file systems report only now that they are full.
    file.as_file().sync_all()?;
    file.persist(&path).map_err(|error| error.error)?;
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::{PermissionsExt as _, symlink};

    #[test]
    fn a_file_is_replaced_with_its_permissions_through_links() {
        let dir = tempfile::tempdir().unwrap();
        let (file, link) = (dir.path().join("file"), dir.path().join("link"));
        save(&file, b"one").unwrap();
        // The mode follows the umask, as for any program.
        fs::write(dir.path().join("other"), b"").unwrap();
        let mode = |path: &Path| path.metadata().unwrap().permissions().mode();
        assert_eq!(mode(&file), mode(&dir.path().join("other")));
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("file", &link).unwrap();
        let before = File::open(&file).unwrap();
        save(&link, b"two").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"two");
        assert_eq!(mode(&file) & 0o777, 0o640);
        assert!(link.symlink_metadata().unwrap().is_symlink());
        assert_eq!(io::read_to_string(before).unwrap(), "one", "who has the old file open keeps it");
        assert_eq!(fs::read_dir(&dir).unwrap().count(), 3);
    }

    #[test]
    fn regular_files_alone_are_read_and_up_to_a_limit() {
        let dir = tempfile::tempdir().unwrap();
        let path = |name: &str| dir.path().join(name);
        save(&path("file"), b"12345").unwrap();
        symlink("/dev/zero", path("device")).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(path("pipe")).status().unwrap().success());
        assert_eq!(read(&path("file"), 5).unwrap(), b"12345");
        let message = |name: &str| read(&path(name), 4).unwrap_err().to_string();
        assert_eq!(message("file"), "it has more than 4 bytes");
        assert_eq!(message("device"), "it is a pipe or a device, and no file");
        assert_eq!(message("pipe"), "it is a pipe or a device, and no file");
        assert_eq!(read(dir.path(), 4).unwrap_err().to_string(), "it is a folder, and no file");
        assert_eq!(read(&path("none"), 4).unwrap_err().kind(), io::ErrorKind::NotFound);
    }

    #[test]
    fn a_full_device_is_an_error_and_a_missing_folder_is_made() {
        let dir = tempfile::tempdir().unwrap();
        let link = dir.path().join("full.png");
        symlink("/dev/full", &link).unwrap();
        assert_eq!(save(&link, &[0; 9]).unwrap_err().kind(), io::ErrorKind::StorageFull);
        save(Path::new("/dev/null"), b"gone").unwrap();
        assert_eq!(fs::read_dir(&dir).unwrap().count(), 1);
        let deep = dir.path().join("made/too/file");
        save(&deep, b"there").unwrap();
        assert_eq!(fs::read(&deep).unwrap(), b"there");
        let message = |made: Result<(), Failure>| format!("{:?}", made.unwrap_err());
        assert!(message(make_folder(&deep)).contains("is a file"));
        assert!(message(make_parent(&deep.join("under"))).contains("is a file"));
    }
}
