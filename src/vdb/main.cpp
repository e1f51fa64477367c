// The helper abbe-vdb: everything that is done with OpenVDB, in a process of its own, so that a damaged file can at
// worst end this one. It is started by src/volumes/vdb_file.cpp and answers with the frames of
// volumes/vdb_message.h.
#include "vdb/commands.h"
#include "vdb/output.h"

#include <cstdio>
#include <cstdlib>
#include <unistd.h>
#include <vector>

int main(int argc, char** argv) {
    if (argc < 4 || ::isatty(STDOUT_FILENO)) {
        std::fputs("abbe-vdb is started by abbe; see `abbe volume --help`\n", stderr);
        return 2;
    }
    // The memory in bytes, the command, and a file or the kind of volume to make.
    using namespace abbe;
    vdb::takeOutput();
    vdb::setLimits(argv[3], std::strtoull(argv[1], nullptr, 10));
    vdb::run(argv[2], std::vector<std::string>(argv + 3, argv + argc));
    ::_exit(0); // without the destructors of libraries, which have nothing to save
}
