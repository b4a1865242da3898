//! The shaders are compiled into the binary: a new file there must rebuild the crate, too.

fn main() {
    println!("cargo:rerun-if-changed=shaders");
}
