#include "client/web/report_maker.h"

#include <boost/asio/post.hpp>
#include <utility>

namespace mortise::web {

void ReportMaker::start(asio::any_io_executor where, Make make, Done done) {
  finish();
  busy_ = true;
  thread_ = std::jthread([this, where, make = std::move(make), done = std::move(done)]() mutable {
    auto made = std::make_shared<Result<std::string>>(make());
    asio::post(where, [this, made, done = std::move(done)] {
      busy_ = false;
      done(std::move(*made));
    });
  });
}

void ReportMaker::finish() {
  if (thread_.joinable()) thread_.join();
}

}  // namespace mortise::web
