// A command as the program knows it: one row of a table, and the object that holds what it was asked to do.
#pragma once

#include "app/console.h"
#include "app/program_end.h"
#include "command_line/arguments.h"

#include <memory>
#include <span>

namespace abbe {

// What one command line asks for: its arguments are read into it, and then it runs.
class Command {
  public:
    virtual ~Command() = default;
    // Adds its arguments, whose places are in this object.
    virtual void list(Arguments&) = 0;
    // Reports what is wrong itself; exceptions that leave it are system errors (IoError, std::bad_alloc) or bugs.
    virtual ExitCode execute(const CommonOptions&) const = 0;
    // Whether what it has to say on stdout is only beside the files that it makes.
    virtual bool makesFiles() const = 0;
};

// The command of a slice: `Options` with addArguments(Arguments&, Options&) and run(const Options&, const
// CommonOptions&) beside it, and perhaps a member makesFiles().
template <typename Options> class CommandOf final : public Command {
  public:
    void list(Arguments& arguments) override { addArguments(arguments, options); }
    ExitCode execute(const CommonOptions& common) const override { return run(options, common); }
    bool makesFiles() const override {
        if constexpr (requires { options.makesFiles(); })
            return options.makesFiles();
        else
            return false;
    }

    Options options;
};

template <typename Options> std::unique_ptr<Command> makeCommand() { return std::make_unique<CommandOf<Options>>(); }

// What a command was asked to do, or null if it is another one.
template <typename Options> const Options* optionsOf(const Command& command) {
    const auto* const of = dynamic_cast<const CommandOf<Options>*>(&command);
    return of ? &of->options : nullptr;
}

struct CommandEntry {
    const char* name;
    const char* group;                  // heading in the list of commands; empty for an action of a command
    const char* help;                   // what `--help` begins with: a sentence on a line of its own, then examples
    std::unique_ptr<Command> (*make)(); // null: there are only its actions
    std::span<const CommandEntry> actions{};
};

// The whole program.
struct CommandTable {
    const char* firstWords; // all that `abbe` alone says
    const char* about;      // what `abbe --help` begins with
    std::span<const CommandEntry> commands;
};

} // namespace abbe
