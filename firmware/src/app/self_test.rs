//! The self test of converter, wiring and load cell, as part of the main loop.

use super::{App, Job};
use crate::line::{Line, Mean};
use crate::self_test::{SelfTest, part_of_range};
use crate::store::Store;
use crate::text::{Fixed, text};
use embedded_io::{Read, ReadReady, Write};

impl<P: Read + ReadReady + Write, S: Store> App<'_, P, S> {
    pub(super) fn begin_self_test(&mut self) {
        let test = SelfTest::new();
        self.shared.want(test.input());
        self.job = Job::SelfTest(test);
    }

    #[inline(never)]
    pub(super) fn self_test(&mut self, mean: Mean) {
        self.console.tell(&Line::Mean(mean));
        let Job::SelfTest(test) = &mut self.job else { return };
        if let Some(trouble) = SelfTest::judge(&mean, &self.settings) {
            test.fail();
            self.console.trouble(trouble);
        }
        if test.advance() {
            return self.shared.want(test.input());
        }
        let passed = test.passed();
        let percent = 100.0 * part_of_range(mean.mean, &self.settings);
        if mean.count > 0 {
            self.info(&text(("load ", Fixed(percent, 1), " % of the range")));
        }
        self.job = Job::Idle;
        self.shared.want(crate::adc::Input::Bridge);
        self.console.tell(&Line::Health(self.health()));
        self.info(if passed { "self test passed" } else { "self test FAILED" });
    }
}
