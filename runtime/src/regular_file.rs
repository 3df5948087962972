//! Opening what is a file. A device or a pipe may never end, and a folder has no text.

use std::fs::{self, File};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Opens a regular file, or a link to one.
///
/// # Errors
/// What the system says; [`ErrorKind::InvalidInput`] for a device, a pipe or a socket.
pub fn open(path: &Path) -> Result<File> {
    // Opening a pipe waits for its other end, so it is looked at before.
    check(&fs::metadata(path)?)?;
    let file = File::open(path)?;
    check(&file.metadata()?)?;
    Ok(file)
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// As [`open`]; [`ErrorKind::FileTooLarge`] for a longer file.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // One byte more than may be there shows that there are too many.
    open(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let message = format!("it is longer than {most} bytes, the most that such a file has");
        return Err(Error::new(ErrorKind::FileTooLarge, message));
    }
    Ok(bytes)
}

/// [`read`], as text.
///
/// # Errors
/// As [`read`]; [`ErrorKind::InvalidData`] for what is not UTF-8.
pub fn read_text(path: &Path, most: u64) -> Result<String> {
    let not_text = |_| Error::new(ErrorKind::InvalidData, "it is not UTF-8 text");
    String::from_utf8(read(path, most)?).map_err(not_text)
}

fn check(found: &fs::Metadata) -> Result<()> {
    if found.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    if !found.is_file() {
        let message = "it is a device or a pipe, a file was expected";
        return Err(Error::new(ErrorKind::InvalidInput, message));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_a_folder_and_a_file_that_is_too_long_are_refused() {
        let folder = std::env::temp_dir();
        assert_eq!(open(&folder).expect_err("a folder").kind(), ErrorKind::IsADirectory);
        if Path::new("/dev/zero").exists() {
            assert_eq!(
                read(Path::new("/dev/zero"), 10).expect_err("a device").kind(),
                ErrorKind::InvalidInput
            );
        }
        let path = folder.join(format!("dynid-regular-{}", std::process::id()));
        fs::write(&path, "0123456789").expect("a file");
        let (fits, long) = (read_text(&path, 10), read(&path, 9));
        let _ = fs::remove_file(&path);
        assert_eq!(fits.expect("it fits"), "0123456789");
        assert_eq!(long.expect_err("too long").kind(), ErrorKind::FileTooLarge);
    }
}
