use super::*;
use std::fs;

/// Half-planes by 17 x 9 x 5 nodes.
const SHIPPED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/neighbor.fvm");

fn by_model(rest: &str) -> String {
    format!("{HEAD}{PLANE}{rest}[plane.orca]\nmodel = \"{SHIPPED}\"\n{TWO}")
}

#[test]
fn robots_in_the_plane_and_in_space_take_a_model() {
    let of = |text: &str| setup(text).general.half_planes;
    let (driving, flying) = (of(&by_model("")), of(&by_model("safety = \"fly\"\n")));
    assert!(driving.is_some() && driving == flying, "{driving:?} {flying:?}");
    assert_eq!(of(&format!("{HEAD}{PLANE}{TWO}")), None);
    let group = "[[plane.group]]\nrobots.list = [{ start_m = [9, 9] }]\n";
    let inherited = setup(&format!("{}{group}", by_model("")));
    assert_eq!(inherited.groups[0].half_planes, driving);
    let scenario = parse(&by_model("")).expect("a good scenario");
    assert!(scenario.origin.files.iter().any(|file| file == Path::new(SHIPPED)), "{:?}", scenario.origin.files);
    let other = parse(&format!("{HEAD}{PLANE}{TWO}")).expect("a good scenario");
    assert_ne!(scenario.fingerprint(), other.fingerprint());
}

#[test]
fn a_file_that_is_no_model_of_half_planes_is_refused() {
    let whole = fs::read(SHIPPED).expect("a model");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.toml");
    let changed = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = whole.clone();
        change(&mut bytes);
        let sum = staya_voxel::checksum(&bytes).to_le_bytes();
        bytes[44..48].copy_from_slice(&sum);
        bytes
    };
    let circle = changed(&|bytes| {
        // 17 x 9 nodes of two variables.
        bytes[6] = 2;
        bytes[12..14].copy_from_slice(&1_u16.to_le_bytes());
        bytes[36..40].fill(0);
        bytes.truncate(48 + 17 * 9 * 4);
    });
    let narrow = changed(&|bytes| bytes[16..20].copy_from_slice(&(-1.0_f32).to_le_bytes()));
    // All slopes along the other axis.
    let other = changed(&|bytes| bytes[48..].chunks_exact_mut(5).for_each(|node| node[1] = node[1].wrapping_neg()));
    let damaged = whole.iter().enumerate().map(|(at, &byte)| if at == 99 { byte ^ 4 } else { byte }).collect();
    let cases: [(&str, Vec<u8>, &str); 7] = [
        ("circle.fvm", circle, "a function of 2 variables (byte 6) where one of 3 is needed; give a file of"),
        ("narrow.fvm", narrow, "its function is not defined for every pair of robots; give a file of"),
        ("other.fvm", other, "degrees off on average, so it is of another function; give a file of"),
        ("damaged.fvm", damaged, "damaged: the checksum"),
        ("short.fvm", whole[..60].to_vec(), "60 bytes where the model has 3873"),
        ("text.fvm", b"name = \"t\"\n".to_vec(), "no functional voxel model"),
        ("empty.fvm", Vec::new(), "0 bytes where the model has 48"),
    ];
    let refusal = |name: &str| {
        let text = format!("{HEAD}{PLANE}[plane.orca]\nmodel = \"{name}\"\n{TWO}");
        Scenario::parse(&text, &path, &Overrides::default()).expect_err(name).to_string()
    };
    for (name, bytes, expected) in cases {
        fs::write(folder.path().join(name), bytes).expect("a file");
        let error = refusal(name);
        assert!(error.contains(":7:") && error.contains("plane.orca.model: "), "{error}");
        assert!(error.contains(name) && error.contains(expected) && error.contains("; "), "{error}");
    }
    let missing = refusal("none.fvm");
    assert!(missing.contains("none.fvm: ") && missing.ends_with("; file names are relative to the scenario file"));
}

#[test]
fn layers_without_a_formula_take_no_model() {
    let given = by_model("safety = \"template_2k\"\n");
    let error = parse(&given).expect_err("it has its own table").to_string();
    let expected = "s.toml:8:9: plane.orca.model: the layer \"template_2k\" has its own table; \
        give safety = \"orca\" or \"fly\", or leave it out";
    assert_eq!(error, expected);
    let error = parse(&by_model("safety = \"push_out\"\n")).expect_err("no ORCA").to_string();
    assert!(error.contains("give plane.safety = \"orca\""), "{error}");
}
