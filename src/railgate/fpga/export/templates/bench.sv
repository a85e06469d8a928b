{{ heading }}

// Replays {{ core.name }}.vectors, made by an independent model, and compares all outputs in each
// tick: prints PASS, or what differs in the first tick that does, and ends with an error. What it
// reads is told by plusargs: +vectors=FILE, and +ticks=N for only the first N.
module {{ core.name }}_tb;
  localparam integer TICKS = {{ ticks }};
{% for port in inputs %}
  reg {{ port.range }}in_{{ port.name }} = {{ port.start }};
{% endfor %}
{% for port in outputs %}
  wire {{ port.range }}out_{{ port.name }};
  reg {{ port.range }}must_{{ port.name }} = 0;
{% endfor %}

  {{ core.name }} dut (
{% for port in ports %}
    .{{ port.escaped }}({{ port.local }}){{ "," if not loop.last }}
{% endfor %}
  );

  integer file, got, next, signal, tick, ticks;
  reg [63:0] value;
  reg failed = 0;
  reg [1023:0] vectors;

  task advance;
    begin
      got = $fscanf(file, "%d %d %h", next, signal, value);
      if (got != 3) next = TICKS;
    end
  endtask

  task change;
    case (signal)
{% for signal in signals %}
      {{ loop.index0 }}: {{ signal.target }} = value[{{ signal.width - 1 }}:0];
{% endfor %}
      default: failed = 1;
    endcase
  endtask

  task compare;
    begin
{% for port in compared %}
      if (out_{{ port.name }} !== must_{{ port.name }}) begin
        failed = 1;
        $display("tick %0d: {{ port.name }} is %0h, must be %0h", tick, out_{{ port.name }}, must_{{ port.name }});
      end
{% endfor %}
    end
  endtask

  initial begin
    if (!$value$plusargs("vectors=%s", vectors)) vectors = "{{ core.name }}.vectors";
    if (!$value$plusargs("ticks=%d", ticks) || ticks > TICKS) ticks = TICKS;
    file = $fopen(vectors, "r");
    if (file == 0) $fatal(1, "FAIL: no file {{ core.name }}.vectors");
    advance;
    for (tick = 0; tick < ticks && !failed; tick = tick + 1) begin
      while (next == tick) begin
        change;
        advance;
      end
      #1 compare;
      in_sync_clk = 1;
      #1 in_sync_clk = 0;
    end
    if (failed) $fatal(1, "FAIL: {{ core.name }} is not as its model");
    $display("PASS: {{ core.name }}, %0d ticks", ticks);
    $finish;
  end
endmodule
