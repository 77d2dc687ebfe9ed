// The errors that the library throws. The library never prints and never exits; the command line
// turns each of these into one line on stderr and an exit status (see host/app/main.cpp).
#pragma once

#include <impactdic/export.h>

#include <cstdint>
#include <stdexcept>
#include <string>

namespace IMPACTDIC_PUBLIC impactdic {

// Base of every error of ours: WHAT went wrong, WHERE (a file, a byte, an option), a HINT.
class Error : public std::runtime_error {
 public:
  Error(const std::string& what, std::string where = "", std::string hint = "");
  const std::string& where() const { return where_; }
  const std::string& hint() const { return hint_; }
  // "WHAT (WHERE): HINT", always one line.
  std::string line() const;

 private:
  std::string where_, hint_;
};

// The request was wrong: an unknown option, an impossible value. Exit status 2.
class InvalidArgument : public Error {
 public:
  using Error::Error;
};

// A file could not be read, or written. Exit status 1.
class FileError : public Error {
 public:
  using Error::Error;
};

// A file's contents are not what its format promises. Exit status 1.
class FormatError : public FileError {
 public:
  // `offset` is the byte at which the contradiction was found; -1 where that has no meaning.
  FormatError(const std::string& file, std::int64_t offset, const std::string& what,
              const std::string& hint = "");
};

// An OpenCL call failed, or no device answers. Exit status 1.
class OpenClError : public Error {
 public:
  // `call` names the API function, `code` its error code.
  OpenClError(const std::string& call, int code);
  explicit OpenClError(const std::string& what, const std::string& where = "",
                       const std::string& hint = "");
};

// A kernel did not compile: the log, options and device are in the message. Exit status 1.
class BuildError : public Error {
 public:
  using Error::Error;
};

}  // namespace impactdic
