// The only file that knows CLI11, which is slow to compile.
#include "command_line/parser.h"

#include "app/console.h"
#include "app/identity.h"
#include "schema/scene_tree.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

namespace {

using Words = std::vector<std::string>;

constexpr std::size_t kFlagColumn = 28;       // where their descriptions begin
constexpr const char* kOptionalValue = "{.}"; // how the library writes that a flag may have one; `.` without it

// --- what the library knows, as data
// `a|b|c` lists words; capitals (`TIME|off|keep`) stand for something.
std::vector<std::string> choicesOf(const std::string& type) {
    std::vector<std::string> words;
    if (type.find('|') == std::string::npos) return words;
    for (std::size_t begin = 0; begin <= type.size();) {
        const std::size_t end = std::min(type.find('|', begin), type.size());
        const std::string word = type.substr(begin, end - begin);
        if (std::ranges::none_of(word, [](unsigned char c) { return std::isupper(c); })) words.push_back(word);
        begin = end + 1;
    }
    return words;
}

FlagInfo flagOf(const CLI::Option& option) {
    FlagInfo flag;
    for (const std::string& name : option.get_snames()) flag.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) flag.names.push_back("--" + name);
    flag.doc = option.get_description();
    flag.valueOptional = option.get_name(false, true).find('{') != std::string::npos;
    const bool takesValue = option.get_items_expected_max() > 0;
    if (takesValue) flag.value = option.get_type_name();
    if (flag.valueOptional) flag.value = option.get_type_name();
    flag.choices = choicesOf(flag.value);
    return flag;
}

ArgumentInfo argumentOf(const CLI::Option& option) {
    return {option.get_name(true), option.get_description(), choicesOf(option.get_type_name()), option.get_required(),
            option.get_items_expected_max() > 1};
}

// The flag that an unknown one probably means.
std::string flagSuggestion(const CLI::App& command, const std::string& flag) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    const std::vector<std::string_view> candidates(names.begin(), names.end());
    return std::string(schema::nearest(flag, candidates));
}

// The root and everything below it.
CommandInfo describeCommands(const CLI::App& command) {
    CommandInfo info;
    info.name = command.get_name();
    info.group = command.get_group();
    const std::string text = command.get_description();
    const std::size_t end = std::min(text.find('\n'), text.size());
    info.summary = text.substr(0, end);
    info.more = text.substr(std::min(text.find_first_not_of('\n', end), text.size()));
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_positional())
            info.arguments.push_back(argumentOf(*option));
        else
            info.flags.push_back(flagOf(*option));
    }
    for (const CLI::App* below : command.get_subcommands({})) info.actions.push_back(describeCommands(*below));
    return info;
}

// The command that was chosen, or the action of one that has some; the root if there is none.
const CLI::App& chosenCommand(const CLI::App& root) {
    const CLI::App* command = &root;
    for (auto below = command->get_subcommands(); !below.empty(); below = command->get_subcommands())
        command = below.front();
    return *command;
}

// "abbe render", "abbe volume info".
std::string fullName(const CLI::App& command) {
    const CLI::App* above = command.get_parent();
    return above ? fullName(*above) + " " + command.get_name() : command.get_name();
}

// What `--help` of a command prints.
std::string helpText(const CLI::App& command) {
    const CLI::App* above = command.get_parent();
    std::string text = above ? command.help(fullName(*above)) : command.help();
    for (const CLI::Option* option : command.get_options()) {
        const auto at =
            text.find("--" + (option->get_lnames().empty() ? std::string() : option->get_lnames()[0]) + kOptionalValue);
        if (at == std::string::npos) continue;
        const auto mark = text.find(kOptionalValue, at); // "{.} FILE"
        const std::string shown = fmt::format("[={}] ", option->get_type_name());
        text.replace(mark, shown.size(), shown);
    }
    return text;
}

// What was wrong, with the flag that was probably meant.
std::string errorText(const CLI::App& root, const CLI::ParseError& error) {
    const CLI::App& command = chosenCommand(root);
    const std::string where = fullName(command);
    const std::vector<std::string> extra = command.remaining();
    for (const std::string& word : extra) {
        if (word.size() < 2 || word[0] != '-') continue;
        const std::string flag = word.substr(0, word.find('='));
        const std::string near = flagSuggestion(command, flag);
        return fmt::format("abbe: unknown flag `{}`{}\n  `{} --help` lists the flags\n", flag,
                           near.empty() ? "" : fmt::format("; did you mean `{}`?", near), where);
    }
    const std::string message =
        extra.empty() ? std::string(error.what()) : fmt::format("unexpected argument `{}`", extra.front());
    return fmt::format("abbe: {}\n  `{} --help` shows how it is used\n", message, where);
}

// --- from our arguments to the library's

void refuseFault(const std::string& names, const std::string& fault) {
    if (!fault.empty()) throw CLI::ValidationError(names, fault);
}

// Where a value goes, one function for each kind of place.
struct Storing {
    std::string names;

    template <typename Number> static bool storeNumber(const std::string& text, Number& place) {
        return CLI::detail::lexical_cast(text, place);
    }
    template <typename Number> CLI::callback_t number(Number* place) const {
        return [place](const CLI::results_t& texts) { return storeNumber(texts[0], *place); };
    }
    template <typename Number> CLI::callback_t optionalNumber(std::optional<Number>* place) const {
        return [place](const CLI::results_t& texts) {
            Number value{};
            if (!storeNumber(texts[0], value)) return false;
            *place = value;
            return true;
        };
    }
    CLI::callback_t operator()(bool* place) const { return number(place); }
    CLI::callback_t operator()(int* place) const { return number(place); }
    CLI::callback_t operator()(std::uint32_t* place) const { return number(place); }
    CLI::callback_t operator()(double* place) const { return number(place); }
    CLI::callback_t operator()(std::optional<int>* place) const { return optionalNumber(place); }
    CLI::callback_t operator()(std::optional<std::int64_t>* place) const { return optionalNumber(place); }
    CLI::callback_t operator()(std::optional<float>* place) const { return optionalNumber(place); }
    CLI::callback_t operator()(std::string* place) const {
        return [place](const CLI::results_t& texts) { return (*place = texts[0], true); };
    }
    CLI::callback_t operator()(std::optional<std::string>* place) const {
        return [place](const CLI::results_t& texts) { return (*place = texts[0], true); };
    }
    CLI::callback_t operator()(Words* place) const {
        return [place](const CLI::results_t& texts) { return (*place = texts, true); };
    }
    CLI::callback_t operator()(std::vector<double>* place) const {
        return [place](const CLI::results_t& texts) {
            place->resize(texts.size());
            for (std::size_t i = 0; i < texts.size(); ++i)
                if (!storeNumber(texts[i], (*place)[i])) return false;
            return true;
        };
    }
    CLI::callback_t operator()(const Argument::TextReader& read) const {
        return [n = names, read](const CLI::results_t& texts) { return (refuseFault(n, read(texts[0])), true); };
    }
    CLI::callback_t operator()(const Argument::ListReader& read) const {
        return [n = names, read](const CLI::results_t& texts) { return (refuseFault(n, read(texts)), true); };
    }
    CLI::callback_t operator()(const Argument::Action& act) const {
        return [act](const CLI::results_t&) { return (act(), true); };
    }
};

// The messages name integers as integers.
void addRange(CLI::Option& option, const Argument& argument, const Argument::Range& range) {
    const bool whole = !std::holds_alternative<double*>(argument.place) &&
                       !std::holds_alternative<std::optional<float>*>(argument.place);
    if (std::isinf(range.most))
        option.check(CLI::NonNegativeNumber.description(""));
    else if (whole)
        option.check(
            CLI::Range(static_cast<std::int64_t>(range.least), static_cast<std::int64_t>(range.most)).description(""));
    else
        option.check(CLI::Range(range.least, range.most).description(""));
}

// Words as the library takes them, the last one first, with `--png off` and `--png look.png` as one word. What else
// follows `--png` may be the scene.
Words libraryWords(Words words) {
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        const std::string& next = words[i + 1];
        if (words[i] != "--png" || !(next == "off" || next == "on" || next.ends_with(".png"))) continue;
        words[i] += "=" + next;
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
    std::ranges::reverse(words);
    return words;
}

// One parser per command line: holds the library's, and the commands that it writes into.
class Parser {
  public:
    explicit Parser(const CommandTable& table) : app_(table.about) {
        app_.name("abbe");
        app_.set_version_flag("-V,--version", versionText(), "Print the version and what it was built with");
        app_.set_help_flag("-h,--help", "Print this help");
        app_.require_subcommand(1);
        app_.get_formatter()->column_width(kFlagColumn);
        for (const CommandEntry& entry : table.commands) add(app_, entry);
    }

    CommandInfo describe() const { return describeCommands(app_); }
    std::optional<std::string> help(std::span<const std::string> words) const;
    std::variant<CommandLine, EarlyEnd> read(const Words& words);

  private:
    struct Made {
        Made(const CLI::App* parserOfIt, std::unique_ptr<Command> made, CommonOptions& common)
            : app(parserOfIt), command(std::move(made)), arguments(common) {}
        const CLI::App* app;
        std::unique_ptr<Command> command;
        Arguments arguments;
        std::deque<std::string> texts;               // of flags with an optional value
        std::vector<std::function<void()>> optional; // read them
    };

    void add(CLI::App& above, const CommandEntry&);
    static CLI::Option* addFlag(CLI::App&, Made&, const Argument&);
    static CLI::Option* addValue(CLI::App&, const Argument&);

    CLI::App app_;
    CommonOptions common_;
    std::deque<Made> commands_;
};

void Parser::add(CLI::App& above, const CommandEntry& entry) {
    CLI::App* const app = above.add_subcommand(entry.name, entry.help);
    app->set_help_flag("-h,--help", "Print this help");
    app->get_formatter()->column_width(kFlagColumn);
    if (&above == &app_) {
        app->group(entry.group);
        Arguments color(common_);
        color.choice<ColorMode>(
            "--color", common_.color,
            {{"auto", ColorMode::automatic}, {"always", ColorMode::always}, {"never", ColorMode::never}},
            "When to use colours");
        addValue(*app, color.all()[0]);
    }
    for (const CommandEntry& action : entry.actions) add(*app, action);
    if (!entry.make) {
        app->require_subcommand(1);
        return;
    }
    Made& made = commands_.emplace_back(app, entry.make(), common_);
    made.command->list(made.arguments);
    for (const Argument& argument : made.arguments.all()) {
        const bool takesValue = !argument.isFlag() || !argument.value.empty();
        CLI::Option* const option =
            takesValue && !argument.valueOptional ? addValue(*app, argument) : addFlag(*app, made, argument);
        if (!argument.group.empty()) option->group(argument.group);
    }
    app->callback([&made] {
        for (const auto& read : made.optional) read();
        for (const auto& check : made.arguments.checks())
            if (const auto fault = check()) throw CLI::ValidationError(fault->argument, fault->text);
    });
}

CLI::Option* Parser::addFlag(CLI::App& app, Made& made, const Argument& argument) {
    if (auto* const place = std::get_if<bool*>(&argument.place))
        return app.add_flag(argument.names, **place, argument.help);
    if (const auto* act = std::get_if<Argument::Action>(&argument.place))
        return app.add_flag_callback(argument.names, *act, argument.help);
    std::string& text = made.texts.emplace_back();
    CLI::Option* const option = app.add_flag(argument.names + kOptionalValue, text, argument.help);
    option->type_name(argument.value);
    made.optional.push_back([option, &text, read = std::get<Argument::TextReader>(argument.place)] {
        if (option->count() > 0) refuseFault(option->get_name(), read(text));
    });
    return option;
}

CLI::Option* Parser::addValue(CLI::App& app, const Argument& argument) {
    CLI::Option* const option =
        app.add_option(argument.names, std::visit(Storing{argument.names}, argument.place), argument.help);
    option->type_name(argument.value);
    const bool list =
        std::holds_alternative<Words*>(argument.place) || std::holds_alternative<Argument::ListReader>(argument.place);
    // What is left on the line goes to an argument, and one value to each use of a flag.
    if (list) option->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args(!argument.isFlag());
    if (argument.numbers > 1) option->delimiter(',')->expected(argument.numbers);
    if (argument.required) option->required();
    if (!argument.choices.empty()) option->check(CLI::IsMember(argument.choices).description(""));
    if (const auto& range = argument.range) addRange(*option, argument, *range);
    return option;
}

std::variant<CommandLine, EarlyEnd> Parser::read(const Words& words) {
    try {
        app_.parse(libraryWords(words));
    } catch (const CLI::CallForHelp&) {
        const CLI::App& chosen = chosenCommand(app_);
        return EarlyEnd{ExitCode::done, &chosen == &app_ ? commandListText(describe()) : helpText(chosen)};
    } catch (const CLI::CallForVersion&) {
        return EarlyEnd{ExitCode::done, versionText() + "\n"};
    } catch (const CLI::ParseError& e) {
        return EarlyEnd{ExitCode::usage, errorText(app_, e)};
    }
    common_.console = Console(common_.color, common_.format);
    common_.commandLine = "abbe";
    for (const std::string& word : words) common_.commandLine += " " + shellQuoted(word);
    common_.words = words;
    const auto chosen = std::ranges::find(commands_, &chosenCommand(app_), &Made::app);
    return CommandLine{std::move(chosen->command), common_};
}

std::optional<std::string> Parser::help(std::span<const std::string> words) const {
    if (words.empty()) return commandListText(describe());
    const CLI::App* command = &app_;
    for (const std::string& word : words) {
        const auto named = command->get_subcommands([&](const CLI::App* c) { return c->get_name() == word; });
        if (named.empty()) return std::nullopt;
        command = named.front();
    }
    const std::string text = helpText(*command);
    if (words.size() > 1 || !schema::findKind(words[0])) return text;
    return text + fmt::format("\n`{0}` is a word of scenes, too: `abbe explain {0}`\n", words[0]);
}

} // namespace

bool isCommand(const CommandTable& table, std::string_view word) {
    return std::ranges::find(table.commands, word, &CommandEntry::name) != table.commands.end();
}

std::string commandSuggestion(const CommandTable& table, const std::string& word) {
    std::error_code error;
    if (word.find_first_of("./-") != std::string::npos || std::filesystem::exists(word, error)) return {};
    std::vector<std::string_view> names;
    for (const CommandEntry& entry : table.commands) names.emplace_back(entry.name);
    return std::string(schema::nearest(word, names));
}

CommandInfo commandTree(const CommandTable& table) { return Parser(table).describe(); }

std::optional<std::string> commandHelp(const CommandTable& table, std::span<const std::string> words) {
    return Parser(table).help(words);
}

std::variant<CommandLine, EarlyEnd> readCommandLine(const CommandTable& table, std::span<const char* const> arguments) {
    Words words(arguments.begin(), arguments.end());
    if (words.empty()) return EarlyEnd{ExitCode::usage, table.firstWords};
    const bool global = words[0] == "-h" || words[0] == "--help" || words[0] == "-V" || words[0] == "--version";
    if (!isCommand(table, words[0]) && !global) {
        if (const std::string near = commandSuggestion(table, words[0]); !near.empty())
            return EarlyEnd{ExitCode::usage,
                            fmt::format("abbe: no command is named `{}`; did you mean `{}`?\n", words[0], near)};
        words.insert(words.begin(), "render");
    }
    return Parser(table).read(words);
}

std::variant<CommandLine, EarlyEnd> readCommandLine(const CommandTable& table,
                                                    const std::vector<std::string>& arguments) {
    std::vector<const char*> words;
    for (const std::string& argument : arguments) words.push_back(argument.c_str());
    return readCommandLine(table, words);
}

} // namespace abbe
