// The web server of a view: the page and what it asks for, on this machine alone and for those alone who know the
// token.
#pragma once

#include "view/view_session.h"

#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace abbe {

// A file of the page, which is part of the program.
struct PageFile {
    std::string_view name, text;
};
std::span<const PageFile> viewPageFiles(); // made by the build from src/view/page

class ViewServer {
  public:
    // Listens on 127.0.0.1; `port` 0: any that is free. Throws IoError if that cannot be had. The session outlives it.
    ViewServer(ViewSession&, int port);
    ~ViewServer();
    ViewServer(const ViewServer&) = delete;
    ViewServer& operator=(const ViewServer&) = delete;

    // With the token.
    std::string url() const;
    // Answers from threads of its own until the object goes.
    void start();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace abbe
