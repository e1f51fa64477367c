#include "base/file.h"
#include "base/process.h"
#include "command_line/shared_arguments.h"
#include "commands/command_table.h"
#include "view/view_server.h"

#include <chrono>
#include <fcntl.h>
#include <fmt/format.h>
#include <thread>
#include <unistd.h>

namespace abbe {

const char* const kViewHelp = R"(Shows a scene in a browser while it is being edited.

Examples:
  abbe view room.scene                  prints the address of the page; Ctrl-C ends it
  abbe view room.scene --open           and opens it
  abbe view room.scene --size 640x360 --samples 256
  abbe view room.scene --tev            shows the picture in tev as well
  abbe view room.scene --port 8080      the same address each time, but for its token

The picture begins anew whenever the scene or a file that it names is saved, and whenever the camera is moved in the
page. The page is for this machine alone, and for those who know the token in its address.)";

void addArguments(Arguments& a, ViewRequest& o) {
    a.argument("scene", &o.input.path, "Scene file").require();
    a.value("--port", "N", &o.port, "Port of this machine; without it a free one").between(1, 65535);
    a.flag("--open", &o.open, "Open the page in the browser");
    addTev(a, o.tev, "Show the picture and its layers in tev, too; 127.0.0.1:14158");
    addFrame(a, o.build);
    a.value("--samples", "N", &o.build.samples, "Samples per pixel").between(1, 4294967295.0);
    a.read("--adaptive", "on|off", o.build.adaptive, "on or off", readSwitch,
           "More samples where there is more noise, at the same cost");
    addMoment(a, o.input.frame);
    addDefines(a, o.input.defines);
    addLayers(a, o.input.layers);
    addThreads(a);
    addView(a, o.view);
}

namespace {

// Who has no such program opens the page by hand. A browser that is started by it outlives this program, however that
// ends.
void openPage(const std::string& url) {
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    pid_t process = 0;
    if (nowhere >= 0) static_cast<void>(spawnProcess({"xdg-open", url}, nowhere, nowhere, process, true));
    if (nowhere >= 0) ::close(nowhere);
}

// Says it once when the viewer that was asked for is not there, or is no longer.
class TevWatch {
  public:
    void look(const ViewSession& session, const Console& console) {
        const std::string why = session.tevAbsence();
        if (!why.empty() && !absent_) {
            Diagnostics found;
            found.warning("W0679", {}, why).help = kTevHelp;
            console.report(found, {});
        }
        absent_ = !why.empty();
    }

  private:
    bool absent_ = false;
};

} // namespace

// What is missing from the beginning is a slip of the pen; what goes away later may come back.
ExitCode run(const ViewRequest& asked, const CommonOptions& common) {
    if (const std::string why = whyNotRegular(asked.input.path); !why.empty()) {
        common.console.error(fmt::format("cannot read `{}`: {}", asked.input.path, why));
        return ExitCode::system;
    }
    ViewRequest request = asked;
    request.commandLine = common.commandLine;
    InterruptGuard interrupt;
    ViewSession session(request);
    ViewServer server(session, request.port);
    server.start();
    common.console.data(server.url() + "\n");
    if (request.open) openPage(server.url());
    TevWatch tev;
    while (!interrupt.stop()) {
        tev.look(session, common.console);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return ExitCode::done;
}

} // namespace abbe
