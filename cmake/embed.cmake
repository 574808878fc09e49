# Turns a file into a C array: cmake -DINPUT=FILE -DOUTPUT=FILE.c -DNAME=ARRAY -P cmake/embed.cmake
# The array ends with a zero that is not the file's.
file(READ ${INPUT} digits HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${digits}")
get_filename_component(base ${INPUT} NAME)
file(WRITE ${OUTPUT} "/* Made from ${base} by cmake/embed.cmake. */\nextern const unsigned char ${NAME}[];\nconst unsigned char ${NAME}[] = {${bytes}0};\n")
