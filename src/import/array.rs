//! The numbers of an array.
//!
//! Binary numbers follow a header of whole numbers: their bytes, or, if they are compressed, the number of blocks, the bytes of a
//! whole and of the last block, and the compressed bytes of each. As base64 the header and the compressed blocks are two pieces; without
//! compression header and numbers are one. In legacy files they have no header.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::io::Read;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

/// How the numbers of a whole file are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coding {
    pub(super) big_endian: bool,
    /// Bytes of a number of a header: 4 or 8, and 0 where there are no headers.
    pub(super) word: usize,
    pub(super) compressor: Option<Compressor>,
}

/// Ways to compress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Compressor {
    Zlib,
    Lz4,
}

/// Types of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Float(usize),
    Int(usize),
    Unsigned(usize),
}

impl Kind {
    pub(super) fn parse(text: &str) -> Option<Self> {
        Some(match text {
            "Float64" => Self::Float(8),
            "Float32" => Self::Float(4),
            "Int8" => Self::Int(1),
            "Int16" => Self::Int(2),
            "Int32" => Self::Int(4),
            "Int64" => Self::Int(8),
            "UInt8" => Self::Unsigned(1),
            "UInt16" => Self::Unsigned(2),
            "UInt32" => Self::Unsigned(4),
            "UInt64" => Self::Unsigned(8),
            _ => return None,
        })
    }

    /// Bytes of a number.
    pub(super) fn bytes(self) -> usize {
        let (Self::Float(bytes) | Self::Int(bytes) | Self::Unsigned(bytes)) = self;
        bytes
    }

    /// The number in its little-endian bytes.
    fn number(self, bytes: [u8; 8]) -> f64 {
        let word = u64::from_le_bytes(bytes);
        match self {
            Self::Float(4) => f64::from(f32::from_bits(word as u32)),
            Self::Float(_) => f64::from_bits(word),
            Self::Int(size) => {
                let unused = 64 - 8 * size as u32;
                ((word << unused) as i64 >> unused) as f64
            }
            Self::Unsigned(_) => word as f64,
        }
    }
}

/// Bytes as they stand in a file.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stream<'a> {
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

impl<'a> Stream<'a> {
    pub(super) fn from(self, offset: usize) -> Option<Self> {
        Some(match self {
            Self::Raw(bytes) => Self::Raw(bytes.get(offset..)?),
            Self::Base64(text) => Self::Base64(text.get(offset..)?),
        })
    }

    /// The first bytes, and what follows the piece that ends with them.
    fn take(self, count: usize) -> Result<(Cow<'a, [u8]>, Self), String> {
        let ended = || format!("ends before the {count} bytes that it announces");
        match self {
            Self::Raw(bytes) => {
                let (taken, rest) = bytes.split_at_checked(count).ok_or_else(ended)?;
                Ok((Cow::Borrowed(taken), Self::Raw(rest)))
            }
            Self::Base64(text) => {
                let characters = count.div_ceil(3).checked_mul(4).ok_or_else(ended)?;
                let (taken, rest) = text.split_at_checked(characters).ok_or_else(ended)?;
                let mut bytes =
                    BASE64_STANDARD.decode(taken).map_err(|error| format!("is no base64: {error}"))?;
                if bytes.len() < count {
                    return Err(ended());
                }
                bytes.truncate(count);
                Ok((Cow::Owned(bytes), Self::Base64(rest)))
            }
        }
    }
}

impl Coding {
    /// Of legacy files: big-endian numbers and nothing else.
    pub(super) const BARE: Self = Self { big_endian: true, word: 0, compressor: None };

    /// `count` numbers that are written as text.
    pub(super) fn ascii(text: &str, count: usize) -> Result<Vec<f64>, String> {
        let number =
            |word: &str| word.parse::<f64>().map_err(|_| format!("holds {word:?}, which is no number"));
        let numbers: Vec<f64> = text.split_ascii_whitespace().map(number).collect::<Result<_, _>>()?;
        if numbers.len() == count {
            return Ok(numbers);
        }
        Err(format!("has {} numbers, the grid needs {count}", numbers.len()))
    }

    /// `count` numbers of a kind at the start of a stream.
    pub(super) fn binary(self, stream: Stream<'_>, kind: Kind, count: usize) -> Result<Vec<f64>, String> {
        let size = kind.bytes();
        let wanted = count.checked_mul(size).ok_or_else(|| format!("would have {count} numbers"))?;
        let bytes = match self.compressor {
            None => self.plain(stream, wanted)?,
            Some(compressor) => Cow::Owned(self.compressed(stream, compressor, wanted)?),
        };
        let number = |bytes: &[u8]| {
            let mut word = [0; 8];
            word[..size].copy_from_slice(bytes);
            if self.big_endian {
                word[..size].reverse();
            }
            kind.number(word)
        };
        let mut numbers = Vec::new();
        numbers.try_reserve_exact(count).map_err(|_| too_large(wanted))?;
        numbers.extend(bytes.chunks_exact(size).map(number));
        Ok(numbers)
    }

    fn plain(self, stream: Stream<'_>, wanted: usize) -> Result<Cow<'_, [u8]>, String> {
        if self.word == 0 {
            return Ok(stream.take(wanted)?.0);
        }
        let (header, _) = stream.take(self.word)?;
        self.check_size(self.words(&header).sum(), wanted)?;
        let (bytes, _) = stream.take(self.word.saturating_add(wanted))?;
        Ok(match bytes {
            Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[self.word..]),
            Cow::Owned(mut bytes) => {
                bytes.drain(..self.word);
                Cow::Owned(bytes)
            }
        })
    }

    fn compressed(
        self,
        stream: Stream<'_>,
        compressor: Compressor,
        wanted: usize,
    ) -> Result<Vec<u8>, String> {
        let broken = || "has a broken header".to_owned();
        let (first, _) = stream.take(self.word)?;
        let blocks = usize::try_from(self.words(&first).sum::<u64>()).map_err(|_| broken())?;
        let length =
            blocks.checked_add(3).and_then(|words| words.checked_mul(self.word)).ok_or_else(broken)?;
        let (header, rest) = stream.take(length)?;
        let sizes: Vec<u64> = self.words(&header).collect();
        let (whole, last) = (sizes[1], if sizes[2] == 0 { sizes[1] } else { sizes[2] });
        let total = match (blocks as u64).checked_sub(1) {
            None => Some(0),
            Some(wholes) => wholes.checked_mul(whole).and_then(|bytes| bytes.checked_add(last)),
        };
        self.check_size(total.ok_or_else(broken)?, wanted)?;
        let compressed = sizes[3..].iter().try_fold(0_u64, |sum, &size| sum.checked_add(size));
        let compressed = compressed.and_then(|sum| usize::try_from(sum).ok()).ok_or_else(broken)?;
        let (packed, _) = rest.take(compressed)?;
        if wanted > compressor.most_unpacked(compressed) {
            return Err(format!(
                "announces {wanted} bytes in {compressed} compressed ones, more than can be in them"
            ));
        }
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(wanted).map_err(|_| too_large(wanted))?;
        let mut packed = &packed[..];
        for (block, &size) in sizes[3..].iter().enumerate() {
            // The sum fits.
            let (this, rest) = packed.split_at(size as usize);
            packed = rest;
            let length = if block + 1 == blocks { last } else { whole } as usize;
            compressor
                .unpack(this, length, &mut bytes)
                .map_err(|error| format!("cannot be unpacked: {error}"))?;
        }
        Ok(bytes)
    }

    fn check_size(self, found: u64, wanted: usize) -> Result<(), String> {
        if found == wanted as u64 {
            Ok(())
        } else {
            Err(format!("has {found} bytes, the grid needs {wanted}"))
        }
    }

    /// The numbers of a header.
    fn words<'a>(self, header: &'a [u8]) -> impl Iterator<Item = u64> + 'a {
        header.chunks_exact(self.word).map(move |bytes| {
            let digit = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
            if self.big_endian { bytes.iter().fold(0, digit) } else { bytes.iter().rev().fold(0, digit) }
        })
    }
}

impl Compressor {
    /// What so many bytes hold at most: a length of 258 in two bits of deflate, 255 more in each byte of LZ4.
    fn most_unpacked(self, packed: usize) -> usize {
        packed.saturating_mul(match self {
            Self::Zlib => 1032,
            Self::Lz4 => 255,
        })
    }

    /// Adds the `length` bytes of a block.
    fn unpack(self, packed: &[u8], length: usize, bytes: &mut Vec<u8>) -> Result<(), String> {
        let start = bytes.len();
        match self {
            Self::Zlib => {
                // One more than there may be, to see that there is none.
                let mut decoder = flate2::read::ZlibDecoder::new(packed).take(length as u64 + 1);
                decoder.read_to_end(bytes).map_err(|error| error.to_string())?;
            }
            Self::Lz4 => {
                bytes.resize(start + length, 0);
                let filled = lz4_flex::block::decompress_into(packed, &mut bytes[start..]);
                bytes.truncate(start + filled.map_err(|error| error.to_string())?);
            }
        }
        let found = bytes.len() - start;
        match found.cmp(&length) {
            Ordering::Less => Err(format!("a block of {length} bytes has {found}")),
            Ordering::Equal => Ok(()),
            Ordering::Greater => Err(format!("a block of {length} bytes has more")),
        }
    }
}

fn too_large(bytes: usize) -> String {
    format!("of {bytes} bytes does not fit into memory")
}
