#include "client/web/addresses.h"

#include <unistd.h>

#include <filesystem>
#include <iostream>

#include "client/web/private_file.h"
#include "common/messages/names.h"

namespace mortise::web {
namespace {

namespace fs = std::filesystem;

std::string lines_of(const Gateway& gateway, const Tokens& tokens) {
  std::string lines;
  for (const Tokens::Personal& person : tokens.people) {
    lines += std::string(name_of(person.bearer.role)) + " " + person.bearer.name + " " +
             gateway.address(person.token) + "\n";
  }
  if (!tokens.people.empty()) return lines;
  return "designer " + gateway.address(tokens.designer) + "\nobserver " +
         gateway.address(tokens.observer) + "\n";
}

Status replace(const std::string& file, const std::string& text) {
  std::error_code error;
  if (fs::exists(file, error) && !fs::is_regular_file(file, error)) {
    return fail(Code::kInvalidInput,
                "--addresses " + file + ": exists and is not a file; - means stdout");
  }
  const std::string unfinished = file + ".new";
  fs::remove(unfinished, error);
  if (Status written = write_private(unfinished, text); !written) return written;
  fs::rename(unfinished, file, error);
  if (!error) return ok();
  return fail(Code::kRuntime, file + ": cannot be written: " + error.message());
}

}  // namespace

Status say_addresses(const AddressesTo& to, const Gateway& gateway, const Tokens& tokens) {
  if (!to.file.empty() && to.file != "-") return replace(to.file, lines_of(gateway, tokens));
  if (to.file == "-" || ::isatty(STDOUT_FILENO) != 0) {
    std::cout << lines_of(gateway, tokens) << std::flush;
    return ok();
  }
  const std::string address = gateway.address("TOKEN");
  std::cout << "open " << address << " with a token of " << to.tokens << std::endl;
  return ok();
}

}  // namespace mortise::web
