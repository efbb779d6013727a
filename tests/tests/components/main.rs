//! Tests of the staged components: each is specialised with nothing known, compiled, and run on tables made here.
//! A few runs of each also go through the interpreter and must give the same bits.

mod exact;
mod geometry;
mod hostile;
mod lights;
mod materials;
mod mix;
mod native;
mod spawn;
mod residual;
mod sized;
mod textures;
mod traverse;
mod watertight;
mod warps;
