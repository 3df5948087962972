//! From a URDF to the modified Denavit-Hartenberg table that dynid works with, and back. Text in, text out: nothing here
//! reads or writes a file.
//!
//! ```
//! use dynid_urdf::{ImportOptions, import, read};
//!
//! let urdf = br#"<robot name="arm">
//!   <link name="base"/>
//!   <joint name="shoulder" type="continuous">
//!     <parent link="base"/><child link="upper"/><origin xyz="0 0 0.3" rpy="-1.5707963267948966 0 0"/><axis xyz="0 0 1"/>
//!   </joint>
//!   <link name="upper">
//!     <inertial><mass value="2"/><origin xyz="0.1 0 0"/><inertia ixx="0.01" iyy="0.02" izz="0.02"/></inertial>
//!   </link>
//! </robot>"#;
//! let options = ImportOptions::default();
//! let robot = read(urdf, options.snap).expect("a robot without mistakes");
//! let imported = import(&robot, "arm.urdf", &options).expect("a chain");
//! assert!(imported.yaml.contains("{j: 1, sigma: 0, gamma: 0, b: 0.3, alpha: -pi/2, d: 0, theta: q1, r: 0}"));
//! assert!(imported.yaml.contains("MX1: 0.2, M1: 2"));
//! ```
#![deny(missing_docs)]

mod angles;
mod attributes;
mod between;
mod body;
mod by_joint;
mod coaxial;
mod connections;
mod document;
mod ellipsoid_yaml;
mod enclosing;
mod frames;
mod geometry;
mod import;
mod import_options;
mod joint;
mod link;
mod link_bounds;
mod mesh;
mod mistake;
mod mjcf;
mod origin;
mod pose;
mod screw;
mod skeleton;
mod template;
mod text;
mod tree;
mod write_urdf;

pub use between::{PointSpring, stiffness_and_rest};
pub use body::Body;
pub use document::{Urdf, read};
pub use import::{Imported, import, import_with_geometry};
pub use import_options::ImportOptions;
pub use link_bounds::{LinkBound, Meshes};
pub use mesh::mesh_vertices;
pub use mistake::{Mistake, Place};
pub use mjcf::write_mjcf;
pub use pose::Pose;
pub use skeleton::{Mimic, Segment, Skeleton, Tendon, Unlike, armatures, value};
pub use template::{JointFriction, Template, TemplateBody};
pub use write_urdf::write_urdf;
