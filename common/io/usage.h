#pragma once

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace mortise {

/// Ends the reading of a command line: prints help or version where they were asked for, else one
/// line on stderr that says what is wrong and what to do (the nearest known option or command).
/// Returns the exit code of the program.
/// Who links this also ends with one line, not a core, where the system has no memory or thread
/// left.
int exit_of_usage(const CLI::App& app, const CLI::ParseError& error);

}  // namespace mortise
