# Function definitions of more than six parameters, as `file:line: name`: of C that clang-format has laid out, where the
# brace of a definition is alone in the first column behind its parameters.
FNR == 1 { head = "" }
/^[A-Za-z_].*\(/ && !/[;=]/ {
	head = $0
	line = FNR
	next
}
head != "" && /^\{/ {
	name = head
	sub(/^[^(]*__attribute__\(\([^)]*\)\)\)?/, "", name)
	parameters = name
	sub(/\(.*/, "", name)
	sub(/.*[ *]/, "", name)
	sub(/^[^(]*\(/, "", parameters)
	while (gsub(/\([^()]*\)/, "", parameters)) # of pointers to functions
		;
	if (gsub(/,/, "", parameters) > 5)
		print FILENAME ":" line ": " name
	head = ""
	next
}
head != "" && /^[ \t]/ { head = head " " $0; next }
{ head = "" }
