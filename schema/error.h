// Three kinds of error, three ways to say so:
//   our bug            CAIRN_DEMAND(condition, "why") aborts with the condition;
//   the user's input   throw InputError: caught in main() and around a worker's task;
//   the world          files, sockets, corrupt bytes: a [[nodiscard]] Result or Status.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace cairn {

// The user's input is wrong. what() names the file and line, or the step and robot, and says what is allowed;
// what it quotes is escaped as by Escaped (schema/text.h), so that no byte of it ends the message.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& why);
};

// Prints the condition, the place and the message, and aborts.
[[noreturn]] void DemandFailed(const char* condition, const char* file, int line, const std::string& message);

#define CAIRN_DEMAND(condition, message)                                \
  do {                                                                  \
    if (!(condition)) [[unlikely]]                                      \
      ::cairn::DemandFailed(#condition, __FILE__, __LINE__, (message)); \
  } while (false)

enum class Code {
  kOk,
  kNotFound,  // no such file, blob, job
  kCorrupt,   // checksum, truncated, not a Cairn file
  kVersion,   // of a newer format, or another build
  kNoSpace,   // a full disk or store
  kBusy,      // locked by another process
  kRefused,   // a peer said no
  kIo,        // any other failure of a file or socket
};

class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Code code, std::string message) : code_(code), message_(std::move(message)) {}
  static Status Ok() { return {}; }
  bool ok() const { return code_ == Code::kOk; }
  Code code() const { return code_; }
  const std::string& message() const { return message_; }

 private:
  Code code_ = Code::kOk;
  std::string message_;
};

// A value, or the Status that says why there is none.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}         // NOLINT(google-explicit-constructor)
  Result(Status status) : status_(std::move(status)) {  // NOLINT(google-explicit-constructor)
    CAIRN_DEMAND(!status_.ok(), "a Result without a value needs a failure");
  }
  bool ok() const { return value_.has_value(); }
  const Status& status() const { return status_; }
  // Demands ok().
  T& value() & {
    CAIRN_DEMAND(ok(), status_.message());
    return *value_;
  }
  const T& value() const& {
    CAIRN_DEMAND(ok(), status_.message());
    return *value_;
  }
  T&& value() && {
    CAIRN_DEMAND(ok(), status_.message());
    return *std::move(value_);
  }

 private:
  std::optional<T> value_;
  Status status_;
};

}  // namespace cairn
