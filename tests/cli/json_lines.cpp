// Reads stdin and fails unless every line is a JSON value (with --whole: the whole text is one). For each line the
// value of the member named by the first argument is printed.
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

int main(int argc, char** argv) {
    const std::string argument = argc > 1 ? argv[1] : "";
    try {
        if (argument == "--whole") {
            const auto value = nlohmann::json::parse(std::cin);
            return value.is_discarded() ? 1 : 0;
        }
        std::size_t lines = 0;
        for (std::string line; std::getline(std::cin, line); ++lines) {
            const auto value = nlohmann::json::parse(line);
            if (!argument.empty()) std::cout << value.at(argument) << '\n';
        }
        return lines > 0 ? 0 : 1;
    } catch (const std::exception& e) {
        std::cerr << e.what() << '\n';
        return 1;
    }
}
