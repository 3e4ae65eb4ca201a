//! Pictures as PNG, as addresses that hold them.
//!
//! W3C, *Portable Network Graphics Specification*; RFC 1950 and 1951, blocks that are stored; RFC 4648 for base64.

const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
/// Bytes of a block that is stored.
const BLOCK: usize = 65_535;
/// Bytes whose sum of sums stays below 2³².
const SUMMED: usize = 5552;
const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// The address of a picture of this width, whose pixels are numbers of colours.
pub fn address(width: usize, palette: &[[u8; 3]], pixels: &[u8]) -> String {
    let height = pixels.len() / width;
    let mut file = SIGNATURE.to_vec();
    let mut header = [width, height].map(|size| (size as u32).to_be_bytes()).concat();
    // Eight bits for a pixel, numbers of the palette, and nothing special.
    header.extend([8, 3, 0, 0, 0]);
    chunk(&mut file, b"IHDR", &header);
    chunk(&mut file, b"PLTE", &palette.concat());
    // No row is filtered.
    let rows: Vec<u8> =
        pixels.chunks(width).flat_map(|row| std::iter::once(&0).chain(row)).copied().collect();
    chunk(&mut file, b"IDAT", &stored(&rows));
    chunk(&mut file, b"IEND", &[]);
    "data:image/png;base64,".to_owned() + &base64(&file)
}

fn chunk(file: &mut Vec<u8>, name: &[u8; 4], content: &[u8]) {
    file.extend((content.len() as u32).to_be_bytes());
    let start = file.len();
    file.extend(name);
    file.extend(content);
    let check = crc(&file[start..]);
    file.extend(check.to_be_bytes());
}

/// Bytes in the format of zlib, without compression.
fn stored(bytes: &[u8]) -> Vec<u8> {
    let mut found = vec![0x78, 0x01];
    let last = bytes.len().div_ceil(BLOCK).max(1) - 1;
    for (i, block) in bytes.chunks(BLOCK).enumerate() {
        let length = block.len() as u16;
        found.push(u8::from(i == last));
        found.extend(length.to_le_bytes());
        found.extend((!length).to_le_bytes());
        found.extend(block);
    }
    found.extend(adler(bytes).to_be_bytes());
    found
}

fn adler(bytes: &[u8]) -> u32 {
    let (mut a, mut b) = (1u32, 0u32);
    for part in bytes.chunks(SUMMED) {
        for &byte in part {
            a += u32::from(byte);
            b += a;
        }
        (a, b) = (a % 65_521, b % 65_521);
    }
    b << 16 | a
}

fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
    let of_byte = |crc: u32, &byte: &u8| (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc));
    !bytes.iter().fold(u32::MAX, of_byte)
}

fn base64(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for part in bytes.chunks(3) {
        let byte = |i: usize| u32::from(part.get(i).copied().unwrap_or(0));
        let all = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let letter = LETTERS[(all >> (18 - 6 * i) & 63) as usize] as char;
            text.push(if i > part.len() { '=' } else { letter });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of RFC 4648, and the check values of the catalogue of CRCs and of RFC 1950.
    #[test]
    fn codes_are_those_of_their_standards() {
        for (bytes, text) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(crc(b"123456789"), 0xcbf4_3926);
        assert_eq!(adler(b"Wikipedia"), 0x11e6_0398);
    }
}
