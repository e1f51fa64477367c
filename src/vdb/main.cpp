// The helper abbe-vdb. It alone links OpenVDB.
int main() { return 2; }
