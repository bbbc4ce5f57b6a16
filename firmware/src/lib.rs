//! The logger application. See the README.
#![no_std]
