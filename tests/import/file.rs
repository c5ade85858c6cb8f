//! Structured grids in every encoding, written plainly.

use std::io::Write;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

/// Where the numbers are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Placed {
    Ascii,
    Inline,
    AppendedRaw,
    AppendedBase64,
}

/// How they are compressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Compression {
    None,
    Zlib,
    Lz4,
}

/// How a file is written; `kind` is the type of the cell data and, if it is one of floats, of the points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Encoding {
    pub(crate) placed: Placed,
    pub(crate) compression: Compression,
    pub(crate) big_endian: bool,
    pub(crate) word: usize,
    pub(crate) kind: &'static str,
    /// Bytes in each block of zlib beyond those that its header announces.
    pub(crate) excess: usize,
}

impl Default for Encoding {
    fn default() -> Self {
        Self {
            placed: Placed::AppendedRaw,
            compression: Compression::None,
            big_endian: false,
            word: 8,
            kind: "Float64",
            excess: 0,
        }
    }
}

/// Bytes of a block before it is compressed.
const BLOCK: usize = 96;

/// A grid.
#[derive(Clone, Debug)]
pub(crate) struct File {
    pub(crate) first: [i64; 3],
    pub(crate) counts: [usize; 3],
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) arrays: Vec<(String, Vec<f64>)>,
}

impl File {
    fn new(counts: [usize; 3]) -> Self {
        let flat = counts[2] == 1;
        let mut points = Vec::new();
        for k in 0..counts[2] {
            for j in 0..counts[1] {
                for i in 0..counts[0] {
                    let [x, y, z] = [i, j, k].map(|at| at as f64);
                    // Exact in single precision.
                    points.push([x + 0.125 * y, y - 0.0625 * x, if flat { 2.5 } else { z + 0.25 * x }]);
                }
            }
        }
        let cells: usize = counts.iter().map(|&count| (count - 1).max(1)).product();
        let values =
            |step: usize| (0..cells).map(|cell| (cell * step % 5) as f64 / 8.0).collect::<Vec<f64>>();
        let arrays = vec![("alpha.one".to_owned(), values(1)), ("alpha.two".to_owned(), values(3))];
        Self { first: [0; 3], counts, points, arrays }
    }

    /// 4 x 3 cells.
    pub(crate) fn flat() -> Self {
        Self::new([5, 4, 1])
    }

    /// 3 x 2 x 4 cells.
    pub(crate) fn solid() -> Self {
        Self::new([4, 3, 5])
    }

    /// The same grid with one axis the other way round.
    pub(crate) fn reversed(&self, axis: usize) -> Self {
        fn turned<T: Copy>(values: &[T], counts: [usize; 3], axis: usize) -> Vec<T> {
            let place = |index: usize| {
                let mut at =
                    [index % counts[0], index / counts[0] % counts[1], index / counts[0] / counts[1]];
                at[axis] = counts[axis] - 1 - at[axis];
                at[0] + counts[0] * (at[1] + counts[1] * at[2])
            };
            (0..values.len()).map(|index| values[place(index)]).collect()
        }
        let cells = self.counts.map(|count| (count - 1).max(1));
        let arrays = self.arrays.iter().map(|(name, values)| (name.clone(), turned(values, cells, axis)));
        Self { points: turned(&self.points, self.counts, axis), arrays: arrays.collect(), ..self.clone() }
    }

    /// The file.
    pub(crate) fn bytes(&self, encoding: Encoding) -> Vec<u8> {
        let Encoding { placed, compression, big_endian, word, kind, .. } = encoding;
        let point_kind = if kind.starts_with("Float") { kind } else { "Float64" };
        let compressor = match compression {
            Compression::None => "",
            Compression::Zlib => " compressor=\"vtkZLibDataCompressor\"",
            Compression::Lz4 => " compressor=\"vtkLZ4DataCompressor\"",
        };
        let order = if big_endian { "BigEndian" } else { "LittleEndian" };
        let header = if word == 8 { "UInt64" } else { "UInt32" };
        let bounds = |axis: usize| [self.first[axis], self.first[axis] + self.counts[axis] as i64 - 1];
        let extent =
            [0, 1, 2].map(bounds).as_flattened().iter().map(i64::to_string).collect::<Vec<_>>().join(" ");
        let mut appended = Vec::new();
        let mut array = |name: &str, kind: &str, components: usize, values: &[f64]| {
            let head =
                format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"");
            match placed {
                Placed::Ascii => {
                    let words: Vec<String> = values.iter().map(f64::to_string).collect();
                    format!("{head} format=\"ascii\">\n {}\n</DataArray>\n", words.join("\n "))
                }
                Placed::Inline => {
                    let text = base64(&encoding.pieces(kind, values));
                    format!("{head} format=\"binary\">\n   {text}\n</DataArray>\n")
                }
                Placed::AppendedRaw | Placed::AppendedBase64 => {
                    let offset = appended.len();
                    let pieces = encoding.pieces(kind, values);
                    match placed {
                        Placed::AppendedRaw => appended.extend(pieces.concat()),
                        _ => appended.extend(base64(&pieces).into_bytes()),
                    }
                    format!("{head} format=\"appended\" offset=\"{offset}\"/>\n")
                }
            }
        };
        let points = array("Points", point_kind, 3, self.points.as_flattened());
        // Of no interest, and not finite.
        let other =
            array("pressure", "Float64", 1, &vec![f64::NAN; self.arrays.first().map_or(0, |a| a.1.len())]);
        let cell_data: String =
            self.arrays.iter().map(|(name, values)| array(name, kind, 1, values)).collect();
        let mut bytes = format!(
            "<?xml version=\"1.0\"?>\n<!-- made by hand -->\n\
             <VTKFile type=\"StructuredGrid\" version=\"1.0\" byte_order=\"{order}\" header_type=\"{header}\"{compressor}>\n\
             <StructuredGrid WholeExtent=\"{extent}\">\n<Piece Extent=\"{extent}\">\n<PointData></PointData>\n\
             <CellData>\n{other}{cell_data}</CellData>\n<Points>\n{points}</Points>\n</Piece>\n</StructuredGrid>\n"
        )
        .into_bytes();
        if let Placed::AppendedRaw | Placed::AppendedBase64 = placed {
            let name = if placed == Placed::AppendedRaw { "raw" } else { "base64" };
            bytes.extend(format!("<AppendedData encoding=\"{name}\">\n  _").into_bytes());
            bytes.extend(appended);
            bytes.extend(b"\n</AppendedData>\n");
        }
        bytes.extend(b"</VTKFile>\n");
        bytes
    }
}

/// Each piece on its own, one after the other.
fn base64(pieces: &[Vec<u8>]) -> String {
    pieces.iter().map(|piece| BASE64_STANDARD.encode(piece)).collect()
}

impl Encoding {
    fn number(self, kind: &str, value: f64) -> Vec<u8> {
        let mut bytes = match kind {
            "Float64" => value.to_le_bytes().to_vec(),
            "Float32" => (value as f32).to_le_bytes().to_vec(),
            _ => {
                let bits: usize = kind.trim_start_matches(|c: char| !c.is_ascii_digit()).parse().unwrap();
                (value as i64).to_le_bytes()[..bits / 8].to_vec()
            }
        };
        if self.big_endian {
            bytes.reverse();
        }
        bytes
    }

    fn header(self, words: &[usize]) -> Vec<u8> {
        let word = |&value: &usize| {
            let mut bytes = (value as u64).to_le_bytes()[..self.word].to_vec();
            if self.big_endian {
                bytes.reverse();
            }
            bytes
        };
        words.iter().flat_map(word).collect()
    }

    /// The parts that are encoded as base64 on their own.
    fn pieces(self, kind: &str, values: &[f64]) -> Vec<Vec<u8>> {
        let bytes: Vec<u8> = values.iter().flat_map(|&value| self.number(kind, value)).collect();
        if self.compression == Compression::None {
            return vec![[self.header(&[bytes.len()]), bytes].concat()];
        }
        let blocks: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(|block| self.compressed(block)).collect();
        let mut header = vec![blocks.len(), BLOCK, bytes.len() % BLOCK];
        header.extend(blocks.iter().map(Vec::len));
        vec![self.header(&header), blocks.concat()]
    }

    fn compressed(self, block: &[u8]) -> Vec<u8> {
        if self.compression == Compression::Lz4 {
            return lz4_flex::block::compress(block);
        }
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(block).unwrap();
        encoder.write_all(&vec![0; self.excess]).unwrap();
        encoder.finish().unwrap()
    }
}
