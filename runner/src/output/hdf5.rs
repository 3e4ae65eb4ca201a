//! Places for the values of arrays behind an HDF5 file, which was assembled with one value of each.
//!
//! The superblock, the object headers and their messages are those of the HDF5 File Format Specification 3.0, sections II.A,
//! IV.A.1.b and IV.A.2, as `netcdf-writer` makes them: superblock version 2, object headers version 2 without continuations,
//! contiguous storage, and links in the header of the root group.

use hdf5_core::jenkins_lookup3;

/// The end of the file, in the superblock.
const END: usize = 28;
/// The address of the root group, in the superblock.
const ROOT: usize = 36;
/// The checksum of the superblock, which ends it.
const SUPERBLOCK: usize = 44;
const CHECKSUM: usize = 4;

/// Types of messages.
const DATASPACE: u8 = 0x01;
const LINK: u8 = 0x06;
const LAYOUT: u8 = 0x08;

/// The address of data that are nowhere, read as zeros.
const NOWHERE: u64 = u64::MAX;
/// The largest length of a dimension that may grow.
const UNLIMITED: u64 = u64::MAX;
/// Addresses of data are multiples of this.
const ALIGNMENT: u64 = 8;

/// An array of the file.
#[derive(Debug)]
pub struct Array<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its lengths.
    pub shape: Vec<u64>,
    /// Bytes of a value.
    pub size: u64,
    /// Where its values are.
    pub values: Values,
}

/// Where the values of an array are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Values {
    /// Behind the file.
    Behind,
    /// Nowhere: all are 0.
    Zero,
    /// There are none, since a length is 0.
    None,
}

/// Gives arrays in the file `bytes` their shapes, and places behind its end, one after the other, each from a multiple of
/// [`padding`]. `None` if the file is not of the kind above, or has no such array.
pub fn place(bytes: &mut Vec<u8>, arrays: &[Array<'_>]) -> Option<()> {
    bytes.resize(bytes.len() + padding(bytes.len() as u64), 0);
    let mut end = bytes.len() as u64;
    let links = links(bytes)?;
    for array in arrays {
        let (_, header) = links.iter().find(|(name, _)| name.as_slice() == array.name.as_bytes())?;
        let length = array.shape.iter().try_fold(array.size, |all, side| all.checked_mul(*side))?;
        let place = match array.values {
            Values::Behind => Some(end),
            Values::Zero => Some(NOWHERE),
            Values::None => None,
        };
        set(bytes, usize::try_from(*header).ok()?, &array.shape, place.map(|address| (address, length)))?;
        if array.values == Values::Behind {
            end = end.checked_add(length)?.checked_next_multiple_of(ALIGNMENT)?;
        }
    }
    write(bytes, END, end)?;
    seal(bytes, 0, SUPERBLOCK)
}

/// Bytes between `length` and the next place.
pub fn padding(length: u64) -> usize {
    (length.next_multiple_of(ALIGNMENT) - length) as usize
}

/// Sets the shape, and the address and the length of data if there are any, in an object header.
fn set(bytes: &mut [u8], header: usize, shape: &[u64], data: Option<(u64, u64)>) -> Option<()> {
    let (messages, end) = messages(bytes, header)?;
    let of = |kind| messages.iter().find(|message| message.0 == kind).map(|message| message.1);
    let (space, layout) = (of(DATASPACE)?, of(LAYOUT)?);
    // Version 2, and the number of dimensions. Bit 0 of what follows: the largest lengths are stated behind the lengths.
    (bytes.get(space..space + 2)? == [2, u8::try_from(shape.len()).ok()?]).then_some(())?;
    let limited = bytes.get(space + 2)? & 1 != 0;
    for (dimension, &side) in shape.iter().enumerate() {
        let (here, largest) = (space + 4 + 8 * dimension, space + 4 + 8 * (shape.len() + dimension));
        write(bytes, here, side)?;
        if limited && read(bytes, largest, 8)? != UNLIMITED {
            write(bytes, largest, side)?;
        }
    }
    if let Some((address, length)) = data {
        // Version 3, contiguous.
        (bytes.get(layout..layout + 2)? == [3, 1]).then_some(())?;
        write(bytes, layout + 2, address)?;
        write(bytes, layout + 10, length)?;
    }
    seal(bytes, header, end)
}

/// The names of the objects in the root group, and the addresses of their headers.
fn links(bytes: &[u8]) -> Option<Vec<(Vec<u8>, u64)>> {
    let (messages, _) = messages(bytes, usize::try_from(read(bytes, ROOT, 8)?).ok()?)?;
    let link = |at: usize| {
        let flags = *bytes.get(at + 1)?;
        // Bit 4: the character set is stated.
        let at = at + 2 + usize::from(flags >> 4 & 1);
        let width = 1 << (flags & 3);
        let (from, length) = (at + width, usize::try_from(read(bytes, at, width)?).ok()?);
        Some((bytes.get(from..from + length)?.to_vec(), read(bytes, from + length, 8)?))
    };
    messages.iter().filter(|message| message.0 == LINK).map(|message| link(message.1)).collect()
}

/// The messages of an object header, each a type and the place of its content, and the place of the checksum behind them.
fn messages(bytes: &[u8], header: usize) -> Option<(Vec<(u8, usize)>, usize)> {
    (bytes.get(header..header + 5)? == b"OHDR\x02").then_some(())?;
    let flags = *bytes.get(header + 5)?;
    // Bits 0 and 1: the width of the length. The others are of fields that are not there.
    (flags < 4).then_some(())?;
    let width = 1 << flags;
    let mut at = header + 6 + width;
    let end = at + usize::try_from(read(bytes, header + 6, width)?).ok()?;
    let mut messages = Vec::new();
    while at < end {
        messages.push((*bytes.get(at)?, at + 4));
        at += 4 + usize::try_from(read(bytes, at + 1, 2)?).ok()?;
    }
    Some((messages, end))
}

/// Sets the checksum at `end` of the bytes from `start`.
fn seal(bytes: &mut [u8], start: usize, end: usize) -> Option<()> {
    let checksum = jenkins_lookup3(bytes.get(start..end)?);
    bytes.get_mut(end..end + CHECKSUM)?.copy_from_slice(&checksum.to_le_bytes());
    Some(())
}

/// The number of `width` bytes at `at`.
fn read(bytes: &[u8], at: usize, width: usize) -> Option<u64> {
    let mut number = [0; 8];
    number.get_mut(..width)?.copy_from_slice(bytes.get(at..at + width)?);
    Some(u64::from_le_bytes(number))
}

fn write(bytes: &mut [u8], at: usize, number: u64) -> Option<()> {
    bytes.get_mut(at..at + 8)?.copy_from_slice(&number.to_le_bytes());
    Some(())
}
