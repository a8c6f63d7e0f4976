// A job file in YAML, mapped strictly onto schema/job.proto. Nothing is guessed: an unknown key, a wrong
// type, a value out of range, a name that stands for nothing are errors that say file, line, key and what is
// allowed.
#pragma once

#include <map>
#include <string>

#include "coordinator/cli/job_file/catalog.h"
#include "schema/job.pb.h"

namespace cairn::cli {

// Where an input's name stands, and the path as it is to be opened from here.
struct JobInput {
  std::string path;
  std::string where;  // "job.yaml:3: input 'log'", for messages
};

struct ParsedJob {
  proto::Job job;
  std::map<std::string, JobInput> inputs;  // the keys of job.inputs
};

// Paths of inputs are relative to the job file.
// Throws InputError.
ParsedJob ReadJobFile(const std::string& path, const Catalog& catalog);

// Why this is no file that an input could be read from; empty: it is one.
std::string WhyNoFile(const std::string& path);

}  // namespace cairn::cli
