#pragma once

namespace mortise {

/// Reads the command line of mortise-replay and runs the command that it names. Returns the exit
/// code.
int run_replay_program(int argc, char** argv);

}  // namespace mortise
