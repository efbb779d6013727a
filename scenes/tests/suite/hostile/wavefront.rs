//! OBJ and MTL files, each with one fault. What becomes of each stands in `outcomes.txt`.

use super::corpus::Corpus;

/// A triangle of every kind of vertex.
const SOUND: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3/1/1\n";

impl Corpus {
    /// Files of OBJ, and libraries for them.
    pub(super) fn wavefront(&mut self) {
        let mut file = |name: &str, bytes: &[u8]| self.0.push((name.into(), bytes.to_vec()));
        let mut spoilt = |name: &str, mtl: &str| {
            file(&format!("{name}.mtl"), mtl.as_bytes());
            file(&format!("mtl-{name}.obj"), format!("mtllib {name}.mtl\n{SOUND}").as_bytes());
        };
        spoilt("many", &"newmtl a\n".repeat(20_000));
        spoilt("control", "newmtl a\nKd 1 0.5 0\nKs 0.5 0.5 0.5\nNs 20\n");
        spoilt("cut-off", "newmtl a\nKd 1 0");
        spoilt("nan", "newmtl a\nKd nan 0 0");
        spoilt("above-1", "newmtl a\nKd 2 0 -1\nKs 3 3 3\nNs 3e38");
        spoilt("shines-3e38", "newmtl a\nKe 3e38 3e38 3e38");
        spoilt("index-0", "newmtl a\nillum 7\nNi 0");
        spoilt("index-1000", "newmtl a\nillum 7\nNi 1000");
        spoilt("model-11", "newmtl a\nillum 11");
        spoilt("opacity-text", "newmtl a\nd -halo");
        spoilt("unnamed", "newmtl\nKd 1 1 1");
        spoilt("map-missing", "newmtl a\nmap_Kd nowhere.png");
        spoilt("map-not-an-image", "newmtl a\nmap_Kd control.mtl");
        spoilt("map-outside", "newmtl a\nmap_Kd ../outside.png");
        spoilt("map-device", "newmtl a\nmap_Kd /dev/zero");
        spoilt("map-scale-1e39", "newmtl a\nmap_Kd -s 1e39 1 1 control.mtl");
        spoilt("map-option-cut-off", "newmtl a\nmap_Kd -clamp");
        let mut obj = |name: &str, text: &str| file(&format!("obj-{name}.obj"), text.as_bytes());
        obj("control", SOUND);
        obj("empty", "");
        obj("only-vertices", "v 0 0 0\nv 1 0 0\n");
        obj("cut-off", &SOUND[..SOUND.len() - 7]);
        obj("nan", &SOUND.replace("v 1 0 0", "v 1 nan 0"));
        obj("1e39", &SOUND.replace("v 1 0 0", "v 1 1e39 0"));
        obj("3e38", &SOUND.replace("v 1 0 0", "v 3e38 0 0").replace("v 0 1 0", "v -3e38 3e38 0"));
        obj("index-2e64", &SOUND.replace("f 1/", "f 18446744073709551616/"));
        obj("index-hex", &SOUND.replace("f 1/", "f 0x1/"));
        obj("normal-0", &SOUND.replace("vn 0 0 1", "vn 0 0 0"));
        obj("normal-3e38", &SOUND.replace("vn 0 0 1", "vn 3e38 3e38 3e38"));
        obj("face-of-200000", &format!("v 0 0 0\nf{}\n", " 1".repeat(200_000)));
        obj("line-in-a-million-pieces", &"\\\n".repeat(1_000_000));
        obj("ends-in-a-backslash", &format!("{SOUND}\\"));
        obj("carriage-returns", &SOUND.replace('\n', "\r\n"));
        obj("library-missing", &format!("mtllib nowhere.mtl\n{SOUND}"));
        obj("library-outside", &format!("mtllib ..\\outside.mtl\n{SOUND}"));
        obj("library-device", &format!("mtllib /dev/zero\n{SOUND}"));
        obj("library-folder", &format!("mtllib .\n{SOUND}"));
        obj("library-unnamed", &format!("mtllib\n{SOUND}"));
        obj("library-again-and-again", &format!("{}{SOUND}", "mtllib many.mtl\nmtllib ./many.mtl\n".repeat(20_000)));
        file("not-utf-8.mtl", b"newmtl \xff\xfe\nKd 1 1 1");
        file("mtl-not-utf-8.obj", format!("mtllib not-utf-8.mtl\n{SOUND}").as_bytes());
    }
}
