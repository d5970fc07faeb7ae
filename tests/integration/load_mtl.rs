//! Libraries, pictures and slots, from files made in the test.

mod amplitudes;
mod fixture;
mod pictures;
mod recognition;
mod sponza;
mod statements;
