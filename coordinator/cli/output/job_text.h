// Jobs of a service, for people and for programs.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "coordinator/client.h"
#include "schema/wire.pb.h"

namespace cairn::cli {

// Of a key without a name its first letters.
std::string OwnerText(const wire::JobInfo& job);

// A table, a line a job.
std::string JobTable(const std::vector<wire::JobInfo>& jobs);

// All that is known of one, a line each.
std::string JobText(const wire::JobInfo& job);

// With what the store holds, where that is known.
std::string JobJson(const wire::JobInfo& job, const coordinator::StoreFacts* store = nullptr);
std::string JobsJson(const coordinator::JobList& list);
std::string JobsJson(const std::vector<wire::JobInfo>& jobs);  // an array

// "store    1.2 GB of 10.0 GB allowed"
std::string StoreText(const coordinator::StoreFacts& store);

std::string Dump(const nlohmann::ordered_json& json);  // bytes that are no UTF-8 are replaced

// Empty where there is no warning.
std::string WarningText(const std::string& warning);

// "refused  key 2, right 1\n": what a service has refused, by kind; empty where nothing.
std::string RefusedText(const std::map<std::string, std::uint64_t>& refused);

// Why nothing happens to a job that is not over: that no worker is connected; else empty.
std::string WaitText(const wire::JobInfo& job, unsigned workers);

// Nothing more will happen to it by itself.
bool IsOver(const wire::JobInfo& job);

// Of a job that is over: 0 done, 2 its input was bad, else 1.
int ExitCodeOf(const wire::JobInfo& job);

}  // namespace cairn::cli
