//! Words of every command that makes a renderer: how its random numbers are drawn, and how paths end. So what is dumped, explained,
//! timed and traced is what is rendered.

use super::values::{RouletteArg, SamplerArg, power_of_two};
use clap::Args;

/// How random numbers are drawn, and how paths end.
#[derive(Clone, Debug, Default, Args)]
pub struct SamplingArgs {
    /// How random numbers are drawn
    #[arg(long, value_name = "SAMPLER", value_enum, default_value_t)]
    pub sampler: SamplerArg,
    /// Independent sequences that the Sobol points of a pixel come from: 1, 2, 4, …; by fewer there is less error, by 8 the
    /// image tells it [default: 1; 8 where `jerboa render` is asked for --noise or --variance]
    #[arg(long, value_name = "N", value_parser = power_of_two)]
    pub scrambles: Option<u32>,
    /// What Russian roulette ends paths by
    #[arg(long, value_name = "BY", value_enum, default_value_t)]
    pub roulette: RouletteArg,
}
