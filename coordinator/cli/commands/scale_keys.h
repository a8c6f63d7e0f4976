// A key for each worker that `cairn scale` starts: on the coordinator's list, and as a file that is handed to
// the worker.
#pragma once

#include <filesystem>
#include <string>

#include "coordinator/scale/scaler.h"

namespace cairn::cli {

// Where nobody but their owner can come in, none is needed.
class NoKeys : public coordinator::WorkerKeys {
 public:
  bool Needed() const override { return false; }
  Result<std::vector<std::string>> Names() override { return std::vector<std::string>(); }
  cairn::Status Make(const std::string&) override { return cairn::Status::Ok(); }
  cairn::Status Revoke(const std::string&) override { return cairn::Status::Ok(); }
};

class ListedKeys : public coordinator::WorkerKeys {
 public:
  // `list`: of the coordinator. `folder`: NAME.key goes there. `prefix`: of the names that are its own.
  ListedKeys(std::filesystem::path list, std::filesystem::path folder, std::string prefix)
      : list_(std::move(list)), folder_(std::move(folder)), prefix_(std::move(prefix)) {}
  Result<std::vector<std::string>> Names() override;
  cairn::Status Make(const std::string& name) override;
  cairn::Status Revoke(const std::string& name) override;

 private:
  const std::filesystem::path list_, folder_;
  const std::string prefix_;
};

}  // namespace cairn::cli
