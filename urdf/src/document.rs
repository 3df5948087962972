//! A URDF as its XML says.

use std::collections::{HashMap, HashSet};

use roxmltree::{Document, Node};

use crate::attributes::{Reader, elements};
use crate::connections::{check_mimics, connect};
use crate::joint::{Joint, read_joint, read_transmission};
use crate::link::{Link, read_link};
use crate::mistake::{Mistake, Place, START, shown};
use crate::origin::Rounding;
use crate::text::plain;

/// Longest file that is read, bytes: meshes lie in files of their own.
const MAX_BYTES: usize = 1 << 24;
/// Most elements that are read.
const MAX_NODES: u32 = 1 << 20;

/// A URDF that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Urdf {
    /// Name of the robot.
    pub name: String,
    pub(crate) links: Vec<Link>,
    pub(crate) joints: Vec<Joint>,
    /// The link that is nobody's child.
    pub(crate) root: usize,
    /// What is allowed but probably not meant.
    pub warnings: Vec<Mistake>,
    /// The coarsest rounding of a right angle that was taken as it stands, rad.
    pub coarsest_rounding: Option<f64>,
}

/// Reads a URDF from its bytes. `snap` (rad) is how far an angle may be from a multiple of pi/4 to be taken for one.
///
/// # Errors
/// Every mistake of the file, in its order; just one where it is no XML.
pub fn read(bytes: &[u8], snap: f64) -> Result<Urdf, Vec<Mistake>> {
    let text = utf8(bytes).map_err(|mistake| vec![mistake])?;
    let options =
        roxmltree::ParsingOptions { allow_dtd: false, nodes_limit: MAX_NODES, ..Default::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let at = error.pos();
        let place = Place { line: at.row.max(1) as usize, column: at.col.max(1) as usize };
        // The library's words end with the place.
        let words = error.to_string();
        let words = words.rsplit_once(" at ").map_or(words.as_str(), |(before, _)| before);
        let hint = if words.contains("xacro") { ": xacro has to be expanded first" } else { "" };
        vec![Mistake::new(place, format!("not XML: {}{hint}", shown(words)))]
    })?;
    let mut reader = Reader::new(&document);
    let urdf = read_robot(&mut reader, document.root_element(), snap);
    let (mut mistakes, warnings) = (reader.mistakes, reader.warnings);
    mistakes.sort_by_key(|m| m.place);
    match urdf {
        Some(urdf) if mistakes.is_empty() => Ok(Urdf { warnings, ..urdf }),
        _ if mistakes.is_empty() => Err(vec![Mistake::new(START, "no robot in it")]),
        _ => Err(mistakes),
    }
}

/// The text of a file that is not too long. A byte order mark stays: bytes are counted from the file's beginning.
pub(crate) fn utf8(bytes: &[u8]) -> Result<&str, Mistake> {
    if bytes.len() > MAX_BYTES {
        let message = format!("the file has {} bytes; a robot has at most {MAX_BYTES}", bytes.len());
        return Err(Mistake::new(START, message));
    }
    std::str::from_utf8(bytes).map_err(|error| {
        let good = String::from_utf8_lossy(&bytes[..error.valid_up_to()]).into_owned();
        let place = Place {
            line: good.matches('\n').count() + 1,
            column: good.chars().rev().take_while(|&c| c != '\n').count() + 1,
        };
        let byte = bytes[error.valid_up_to()];
        Mistake::new(place, format!("the file is not UTF-8 text (byte 0x{byte:02x} here)"))
    })
}

fn read_robot(reader: &mut Reader<'_>, root: Node<'_, '_>, snap: f64) -> Option<Urdf> {
    let place = reader.place_of(root);
    if root.tag_name().name() != "robot" {
        let found = shown(root.tag_name().name());
        reader.report(place, format!("expected <robot>, found <{found}>"));
        return None;
    }
    if let Some(macros) =
        root.descendants().find(|n| n.tag_name().namespace().is_some_and(|s| s.contains("xacro")))
    {
        let place = reader.place_of(macros);
        reader.report(place, "xacro that is not expanded: run `xacro FILE.xacro > FILE.urdf` first");
        return None;
    }
    let name = root.attribute("name").unwrap_or("robot").to_owned();
    let mut rounding = Rounding { snap, coarsest: None };
    let mut links = Vec::new();
    let mut by_name = HashMap::new();
    for node in elements(root, "link") {
        let Some(link) = read_link(reader, node, &mut rounding) else { continue };
        if by_name.contains_key(&link.name) {
            reader.report(link.place, format!("link '{}' is there twice", shown(&link.name)));
            continue;
        }
        by_name.insert(link.name.clone(), links.len());
        links.push(link);
    }
    let mut joints: Vec<Joint> = Vec::new();
    let mut names = HashSet::new();
    for node in elements(root, "joint") {
        let Some(joint) = read_joint(reader, node, &by_name, &mut rounding) else { continue };
        if !names.insert(joint.name.clone()) {
            reader.report(joint.place, format!("joint '{}' is there twice", shown(&joint.name)));
            continue;
        }
        joints.push(joint);
    }
    for node in elements(root, "transmission") {
        read_transmission(reader, node, &mut joints);
    }
    check_mimics(reader, &joints);
    let root = connect(reader, place, &mut links, &joints)?;
    if let Some(off) = rounding.coarsest.filter(|off| *off > snap) {
        let words = format!(
            "angles such as 1.5708 are taken as they stand, up to {off:.1e} rad from a multiple of pi/4: base parameters \
             appear that no motion shows; where right angles are meant, --snap {} takes them so",
            plain(10_f64.powi(off.log10().ceil() as i32))
        );
        reader.warn(place, words);
    }
    Some(Urdf { name, links, joints, root, warnings: Vec::new(), coarsest_rounding: rounding.coarsest })
}
