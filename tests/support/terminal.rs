//! A console in memory.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_io::{ErrorType, Read, ReadReady, Write};

/// Input and output of the console.
#[derive(Clone, Debug, Default)]
pub struct Terminal {
    keys: Rc<RefCell<VecDeque<u8>>>,
    screen: Rc<RefCell<Vec<u8>>>,
}

impl Terminal {
    /// Adds input, which the board reads later.
    pub fn type_in(&self, keys: &[u8]) {
        self.keys.borrow_mut().extend(keys);
    }

    /// Output since the previous call.
    pub fn said(&self) -> String {
        let said = std::mem::take(&mut *self.screen.borrow_mut());
        String::from_utf8_lossy(&said).into_owned()
    }
}

impl ErrorType for Terminal {
    type Error = Infallible;
}

impl ReadReady for Terminal {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.keys.borrow().is_empty())
    }
}

impl Read for Terminal {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let (Some(slot), Some(key)) = (buffer.first_mut(), self.keys.borrow_mut().pop_front())
        else {
            return Ok(0);
        };
        *slot = key;
        Ok(1)
    }
}

impl Write for Terminal {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.screen.borrow_mut().extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
