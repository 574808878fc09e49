/* Text of XML. */
#include "io/write_text.h"

void laves__write_escaped(laves__output *out, const char *text) {
  for (; *text; text++) switch (*text) {
      case '&':
        laves__output_printf(out, "&amp;");
        break;
      case '<':
        laves__output_printf(out, "&lt;");
        break;
      case '>':
        laves__output_printf(out, "&gt;");
        break;
      case '"':
        laves__output_printf(out, "&quot;");
        break;
      default:
        laves__output_printf(out, "%c", (unsigned char)*text < ' ' ? '_' : *text);
    }
}
