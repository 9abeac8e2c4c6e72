#pragma once
#include <map>
#include <string>

namespace mortise {

/// Version of the project: "major.minor.patch".
std::string engine_version();

/// What --version says, e.g. "mortise-server 1.2.3, build 0123456789ab": programs of one build
/// replay each other's logs bit for bit.
std::string version_line(const std::string& program);

/// Everything that determines the bits of a result: sources of the engine, compiler, its version
/// and flags, build type, processor family. With equal fingerprints a replay agrees bit for bit.
std::string build_fingerprint();

/// The same without the sources: with equal values only a change of the engine changes bits.
std::string toolchain_fingerprint();

/// The same by name, for the metadata of a log.
std::map<std::string, std::string> build_info();

}  // namespace mortise
