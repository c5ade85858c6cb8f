//! The parts of a VTK file. Those of XML are elements, with numbers in them or appended behind them; other files say the same.

use std::path::{Path, PathBuf};

use roxmltree::Node;
use vofkit_geometry::Vector;

use super::array::{Coding, Compressor, Kind, Stream};
use super::error::ImportError;

/// What starts the appended numbers.
const APPENDED: &[u8] = b"<AppendedData";

const REWRITE: &str = "write the file anew with its own program, in one piece";

/// The arrays that a reader asks for: whether it needs one of a name in a section such as `CellData`.
pub(super) type Wanted<'a> = &'a dyn Fn(&str, &str) -> bool;

/// The parts of a file that matter. Of XML they are in what precedes the appended numbers.
pub(super) struct Document<'a> {
    path: PathBuf,
    coding: Coding,
    appended: Option<Stream<'a>>,
    /// Of the piece, and where it has none the extent of the whole.
    attributes: Vec<(String, String)>,
    arrays: Vec<ArrayText>,
}

/// An element `DataArray`.
#[derive(Clone, Debug)]
pub(super) struct ArrayText {
    /// The element that it is in, such as `Points` or `CellData`.
    pub(super) section: String,
    pub(super) name: String,
    pub(super) kind: String,
    pub(super) components: String,
    pub(super) format: String,
    pub(super) offset: String,
    pub(super) text: String,
}

impl ArrayText {
    fn new(section: &str, node: Node<'_, '_>) -> Self {
        let attribute = |name: &str| node.attribute(name).unwrap_or_default().trim().to_owned();
        Self {
            section: section.to_owned(),
            name: attribute("Name"),
            kind: attribute("type"),
            components: attribute("NumberOfComponents"),
            format: attribute("format"),
            offset: attribute("offset"),
            text: node.text().unwrap_or_default().to_owned(),
        }
    }
}

impl<'a> Document<'a> {
    /// Takes a file of a kind apart; arrays that are not wanted are left out.
    pub(super) fn parse(
        path: &Path,
        bytes: &'a [u8],
        kind: &str,
        wanted: Wanted<'_>,
    ) -> Result<Self, ImportError> {
        let wrong = |problem: String| ImportError::Grid { path: path.to_owned(), problem, help: REWRITE };
        let (header, behind) =
            split(bytes).ok_or_else(|| wrong("its appended data have no start".to_owned()))?;
        let text = std::str::from_utf8(header).map_err(|error| {
            wrong(format!("it is no VTK XML file: not UTF-8 at byte {}", error.valid_up_to()))
        })?;
        let closed;
        let text = if behind.is_some() {
            closed = format!("{text}</AppendedData></VTKFile>");
            &closed
        } else {
            text
        };
        let xml = roxmltree::Document::parse(text)
            .map_err(|error| wrong(format!("it is no VTK XML file: {error}")))?;
        let root = xml.root_element();
        let found = root.attribute("type").unwrap_or("nothing");
        if !root.has_tag_name("VTKFile") || found != kind {
            return Err(wrong(format!("it holds {found}, not a {kind}")));
        }
        let coding = coding(root).map_err(wrong)?;
        let whole = child(root, kind);
        let pieces: Vec<_> = whole
            .map(|whole| whole.children().filter(|child| child.has_tag_name("Piece")).collect())
            .unwrap_or_default();
        let [piece] = pieces[..] else {
            return Err(wrong(format!("it has {} pieces, not one", pieces.len())));
        };
        let mut attributes: Vec<(String, String)> =
            piece.attributes().map(|one| (one.name().to_owned(), one.value().to_owned())).collect();
        let extent = whole.and_then(|whole| whole.attribute("WholeExtent"));
        attributes.extend(extent.map(|extent| ("Extent".to_owned(), extent.to_owned())));
        let mut arrays = Vec::new();
        for section in piece.children().filter(Node::is_element) {
            let name = section.tag_name().name();
            let nodes = section.children().filter(|child| child.has_tag_name("DataArray"));
            let is_wanted = |node: &Node<'_, '_>| wanted(name, node.attribute("Name").unwrap_or_default());
            arrays.extend(nodes.filter(is_wanted).map(|node| ArrayText::new(name, node)));
        }
        let appended =
            behind.map(|bytes| match child(root, "AppendedData").and_then(|d| d.attribute("encoding")) {
                Some("base64") => Stream::Base64(bytes),
                _ => Stream::Raw(bytes),
            });
        Ok(Self { path: path.to_owned(), coding, appended, attributes, arrays })
    }

    /// A structured grid whose binary numbers lie bare among the bytes of the file.
    pub(super) fn bare(path: &Path, bytes: &'a [u8], extent: [i64; 6], arrays: Vec<ArrayText>) -> Self {
        let extent = extent.map(|end| end.to_string()).join(" ");
        Self {
            path: path.to_owned(),
            coding: Coding::BARE,
            appended: Some(Stream::Raw(bytes)),
            attributes: vec![("Extent".to_owned(), extent)],
            arrays,
        }
    }

    /// An error of the whole file.
    pub(super) fn wrong(&self, problem: String) -> ImportError {
        ImportError::Grid { path: self.path.clone(), problem, help: REWRITE }
    }

    fn attribute(&self, name: &str) -> &str {
        self.attributes.iter().find(|(key, _)| key == name).map_or("", |(_, value)| value)
    }

    /// A number of things that the piece says it has.
    pub(super) fn count(&self, attribute: &str) -> Result<usize, ImportError> {
        let text = self.attribute(attribute);
        let count = if text.is_empty() { Ok(0) } else { text.trim().parse() };
        count.map_err(|_| self.wrong(format!("its {attribute} is \"{text}\", which counts nothing")))
    }

    /// Nodes along each axis of a structured grid.
    pub(super) fn node_counts(&self) -> Result<[usize; 3], ImportError> {
        let text = self.attribute("Extent");
        let numbers: Vec<i64> = text.split_ascii_whitespace().map_while(|word| word.parse().ok()).collect();
        let extent = <[i64; 6]>::try_from(numbers)
            .map_err(|_| self.wrong(format!("its extent \"{text}\" is not six whole numbers")))?;
        count_nodes(&extent).ok_or_else(|| self.wrong(format!("its extent {extent:?} counts no nodes")))
    }

    /// The arrays of a section in the order of the file.
    pub(super) fn section(&self, section: &str) -> impl Iterator<Item = &ArrayText> {
        self.arrays.iter().filter(move |array| array.section == section)
    }

    /// An array of a section; none if there is no such one.
    ///
    /// # Errors
    /// Two of them.
    pub(super) fn array(&self, section: &str, name: &str) -> Result<Option<&ArrayText>, ImportError> {
        let mut named = self.section(section).filter(|array| array.name == name);
        let first = named.next();
        match named.next() {
            Some(array) => Err(self.twice(array)),
            None => Ok(first),
        }
    }

    /// So many points.
    pub(super) fn points(&self, count: usize) -> Result<Vec<Vector<3>>, ImportError> {
        let Some(array) = self.section("Points").last() else {
            return Err(self.wrong("it has no points".to_owned()));
        };
        self.vectors(array, count, "node", "give every node finite coordinates")
    }

    /// So many vectors with three finite components, one for each place of a kind.
    pub(super) fn vectors(
        &self,
        array: &ArrayText,
        count: usize,
        place: &str,
        help: &'static str,
    ) -> Result<Vec<Vector<3>>, ImportError> {
        let numbers = self.numbers(array, 3, count)?;
        if let Some(at) = numbers.iter().position(|number| !number.is_finite()) {
            let problem = format!("has {:?} in {place} {}, component {}", numbers[at], at / 3, at % 3);
            return Err(self.array_error(array, problem, help));
        }
        Ok(numbers.chunks_exact(3).map(|x| Vector::<3>::new(x[0], x[1], x[2])).collect())
    }

    /// The numbers of all cell arrays whose names start like this, by the rest of their names.
    pub(super) fn cell_arrays(
        &self,
        start: &str,
        counts: [usize; 3],
    ) -> Result<Vec<(String, Vec<f64>)>, ImportError> {
        let cells = counts.iter().map(|&count| (count - 1).max(1)).product::<usize>();
        let named =
            self.section("CellData").filter_map(|array| Some((array.name.strip_prefix(start)?, array)));
        let mut found: Vec<(String, Vec<f64>)> = Vec::new();
        for (name, array) in named {
            if found.iter().any(|(other, _)| other == name) {
                return Err(self.twice(array));
            }
            found.push((name.to_owned(), self.numbers(array, 1, cells)?));
        }
        Ok(found)
    }

    fn twice(&self, array: &ArrayText) -> ImportError {
        self.array_error(array, "is there twice".to_owned(), "remove or rename one of them")
    }

    /// An error of an array.
    pub(super) fn array_error(&self, array: &ArrayText, problem: String, help: &'static str) -> ImportError {
        let array = if array.name.is_empty() { "Points".to_owned() } else { array.name.clone() };
        ImportError::Array { path: self.path.clone(), array, problem, help }
    }

    /// The number of components of an array; 0 where that is no number.
    pub(super) fn width(array: &ArrayText) -> usize {
        if array.components.is_empty() { 1 } else { array.components.parse().unwrap_or(0) }
    }

    /// So many times so many components.
    pub(super) fn numbers(
        &self,
        array: &ArrayText,
        components: usize,
        count: usize,
    ) -> Result<Vec<f64>, ImportError> {
        let wrong = |problem: String| self.array_error(array, problem, REWRITE);
        let found = if array.components.is_empty() { "1" } else { &array.components };
        if found.parse() != Ok(components) {
            return Err(wrong(format!("has {found} components, not {components}")));
        }
        let count = count.checked_mul(components).ok_or_else(|| wrong("is too long".to_owned()))?;
        let Some(kind) = Kind::parse(&array.kind) else {
            return Err(wrong(format!("has the type \"{}\", which is no type of numbers", array.kind)));
        };
        let inline: Vec<u8>;
        let stream = match array.format.as_str() {
            "ascii" | "" => return Coding::ascii(&array.text, count).map_err(wrong),
            "binary" => {
                inline = array.text.bytes().filter(|byte| !byte.is_ascii_whitespace()).collect();
                Some(Stream::Base64(&inline))
            }
            "appended" => {
                let offset = if array.offset.is_empty() { "0" } else { &array.offset };
                self.appended.and_then(|stream| stream.from(offset.parse().ok()?))
            }
            other => return Err(wrong(format!("has the unknown format \"{other}\""))),
        };
        let Some(stream) = stream else {
            return Err(wrong(format!(
                "is said to start at \"{}\" of the appended data, which is not there",
                array.offset
            )));
        };
        self.coding.binary(stream, kind, count).map_err(wrong)
    }
}

/// Nodes along each axis between the first and the last of an extent; none where there are none, or more than can be counted.
pub(super) fn count_nodes(extent: &[i64; 6]) -> Option<[usize; 3]> {
    let count = |axis: usize| {
        let count = extent[2 * axis + 1].checked_sub(extent[2 * axis])?.checked_add(1)?;
        usize::try_from(count).ok().filter(|&count| count > 0)
    };
    let counts = [count(0)?, count(1)?, count(2)?];
    counts.iter().try_fold(1_usize, |total, &count| total.checked_mul(count)).map(|_| counts)
}

/// The XML up to and with the start of appended data, and what follows the mark `_`; none without the mark.
fn split(bytes: &[u8]) -> Option<(&[u8], Option<&[u8]>)> {
    let Some(start) = bytes.windows(APPENDED.len()).position(|window| window == APPENDED) else {
        return Some((bytes, None));
    };
    let end = start + bytes[start..].iter().position(|&byte| byte == b'>')? + 1;
    let mark = end + bytes[end..].iter().position(|&byte| byte == b'_')? + 1;
    Some((&bytes[..end], Some(&bytes[mark..])))
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn coding(root: Node<'_, '_>) -> Result<Coding, String> {
    let big_endian = match root.attribute("byte_order") {
        Some("LittleEndian") | None => false,
        Some("BigEndian") => true,
        Some(other) => return Err(format!("its byte order is \"{other}\"")),
    };
    let word = match root.attribute("header_type") {
        Some("UInt32") | None => 4,
        Some("UInt64") => 8,
        Some(other) => return Err(format!("its header type is \"{other}\"")),
    };
    let compressor = match root.attribute("compressor") {
        None | Some("") => None,
        Some("vtkZLibDataCompressor") => Some(Compressor::Zlib),
        Some("vtkLZ4DataCompressor") => Some(Compressor::Lz4),
        Some(other) => return Err(format!("it is compressed by {other}, not by zlib or LZ4")),
    };
    Ok(Coding { big_endian, word, compressor })
}
