// Tells the service manager that started this process, systemd say, how it stands: a datagram to the socket
// that $NOTIFY_SOCKET names (sd_notify(3), whose library would be one more to link). Where it names none,
// nothing is told.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace cairn {

class ServiceManager {
 public:
  ServiceManager();

  void Ready() { Tell("READY=1"); }
  // Call it with every turn of the loop: it is told three times in the span ($WATCHDOG_USEC) after which a
  // process that says nothing is taken to hang.
  void Alive();
  void Stopping() { Tell("STOPPING=1"); }

 private:
  using Clock = std::chrono::steady_clock;
  void Tell(const char* what) const;

  std::string path_;                    // of its socket; empty: nobody asks
  std::chrono::microseconds every_{0};  // 0: nobody watches
  std::optional<Clock::time_point> told_;
};

}  // namespace cairn
