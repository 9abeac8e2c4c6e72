#pragma once

namespace mortise {

/// What holds for the process of each program of the house: it ends with one line on stderr, not
/// with a core, where the system has no memory or thread left or a file may not grow; and with an
/// error where not all of stdout could be written. Reading a command line (usage.h) begins with it.
void begin_program();

}  // namespace mortise
