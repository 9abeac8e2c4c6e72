#include <cstdio>

#include "client/tools/first_contact/options.h"
#include "client/tools/first_contact/run.h"

int main(int argc, char** argv) {
  const auto line = mortise::read_first_contact_command_line(argc, argv);
  if (line.exit_code >= 0) return line.exit_code;
  const mortise::Status status = mortise::run_first_contact(line.options);
  if (status) return mortise::kExitOk;
  std::fprintf(stderr, "mortise-first-contact: %s\n", status.error().text.c_str());
  return status.error().code == mortise::Code::kRuntime ? mortise::kExitRuntime
                                                        : mortise::kExitBadInput;
}
