//! Passes the linker scripts and their search paths to the linker for the board's programs.

fn main() {
    println!("cargo:rerun-if-changed=src/board/mps2/mps2.x");
    println!("cargo:rerun-if-changed=../memory.x");
    let has = |feature: &str| std::env::var_os(format!("CARGO_FEATURE_{feature}")).is_some();
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let here = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    if has("MPS2_AN386") {
        println!("cargo:rustc-link-arg-bins=-T{here}/src/board/mps2/mps2.x");
    } else if has("NUCLEO_L476") {
        // The script of cortex-m-rt; it includes memory.x from the repository's root.
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
    if has("DEFMT") {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
}
