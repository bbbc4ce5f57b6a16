//! What a browser may do with the page: show it and run its one script.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

/// The page's content security policy, for the text of its `<script>`: nothing is
/// loaded from anywhere, and no other script runs, whatever a log's names hold.
pub(super) fn policy(script: &str) -> String {
    let hash = STANDARD.encode(Sha256::digest(script.as_bytes()));
    format!(
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
         style-src 'unsafe-inline'; script-src 'sha256-{hash}'; base-uri 'none'; \
         form-action 'none'\"/>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hash of the empty text is a published test vector.
    #[test]
    fn the_hash_is_sha_256_in_base_64() {
        let policy = policy("");
        assert!(
            policy.contains("'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='"),
            "{policy}"
        );
    }
}
