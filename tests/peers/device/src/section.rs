//! Marks between which the plugin counts: functions of one instruction whose names it knows.

use core::arch::global_asm;

macro_rules! sections {
    ($($name:ident $symbol:ident),* $(,)?) => {
        $(
            global_asm!(
                concat!(".global ", stringify!($symbol)),
                concat!(".type ", stringify!($symbol), ", %function"),
                ".thumb_func",
                concat!(stringify!($symbol), ":"),
                "bx lr",
                concat!(".size ", stringify!($symbol), ", . - ", stringify!($symbol)),
            );

            /// Ends the section of this name.
            pub fn $name() {
                unsafe extern "C" {
                    fn $symbol();
                }
                // SAFETY: it does nothing but return.
                unsafe { $symbol() }
            }
        )*
    };
}

sections! {
    rest section_rest,
    ours_f32 section_ours_f32,
    ours_integer section_ours_integer,
    ours_period section_ours_period,
    plain_f32 section_plain_f32,
    plain_integer section_plain_integer,
    nalgebra_f32 section_nalgebra_f32,
    microflow_int8 section_microflow_int8,
    burn_f32 section_burn_f32,
}
