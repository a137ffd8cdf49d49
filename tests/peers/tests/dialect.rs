//! Compares `controller/mavlink/src/dialect.rs` with the output of `mavlink-bindgen` for its XML,
//! after removing code for missing features. `STAYA_BLESS=1 cargo test --test dialect` writes it.

use mavlink_bindgen::{XmlDefinitions, generate};
use std::path::Path;
use syn::visit_mut::{self, VisitMut};
use syn::{Attribute, Block, Fields, File, ImplItem, Item, Meta, Stmt, UseTree};

#[test]
fn rust_dialect_matches_its_xml() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../controller/mavlink");
    let file = package.join("src/dialect.rs");
    let fresh = generated(&package.join("messages/staya.xml"));
    if std::env::var_os("STAYA_BLESS").is_some() {
        std::fs::write(&file, fresh).unwrap();
        return;
    }
    let there = std::fs::read_to_string(&file).unwrap();
    let line = there.lines().zip(fresh.lines()).position(|(old, new)| old != new);
    assert!(there == fresh, "{} differs from its XML from line {:?} on", file.display(), line.map(|line| line + 1));
}

fn generated(xml: &Path) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    generate(XmlDefinitions::Files(vec![xml]), folder).unwrap();
    let text = std::fs::read_to_string(folder.join("staya.rs")).unwrap();
    let mut file = syn::parse_file(&text).unwrap();
    Features.visit_file_mut(&mut file);
    prettyplease::unparse(&file)
}

/// Removes code behind Cargo features, and imports that only enums and bit flags need.
struct Features;

impl VisitMut for Features {
    fn visit_file_mut(&mut self, file: &mut File) {
        file.items.retain(|item| match item {
            Item::Use(item) => !of_feature(&item.attrs) && !only_for_enums(&item.tree),
            _ => true,
        });
        visit_mut::visit_file_mut(self, file);
    }

    fn visit_item_impl_mut(&mut self, item: &mut syn::ItemImpl) {
        item.items.retain(|item| !matches!(item, ImplItem::Fn(function) if of_feature(&function.attrs)));
        visit_mut::visit_item_impl_mut(self, item);
    }

    fn visit_block_mut(&mut self, block: &mut Block) {
        block.stmts.retain(|stmt| !matches!(stmt, Stmt::Item(Item::Use(item)) if of_feature(&item.attrs)));
        visit_mut::visit_block_mut(self, block);
    }

    fn visit_fields_mut(&mut self, fields: &mut Fields) {
        visit_mut::visit_fields_mut(self, fields);
        assert!(fields.iter().all(|field| !of_feature(&field.attrs)), "a field behind a feature");
    }

    fn visit_attributes_mut(&mut self, attributes: &mut Vec<Attribute>) {
        attributes.retain(|attribute| !attribute.path().is_ident("cfg_attr"));
    }
}

fn of_feature(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| matches!(&attribute.meta, Meta::List(list) if list.path.is_ident("cfg")))
}

fn only_for_enums(tree: &UseTree) -> bool {
    matches!(tree, UseTree::Path(path) if ["bitflags", "num_derive", "num_traits"].iter().any(|name| path.ident == name))
}
