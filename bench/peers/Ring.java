import java.io.StringReader;
import java.util.Locale;
import java.util.Set;
import org.apache.commons.scxml.SCXMLExecutor;
import org.apache.commons.scxml.TriggerEvent;
import org.apache.commons.scxml.env.SimpleDispatcher;
import org.apache.commons.scxml.env.SimpleErrorHandler;
import org.apache.commons.scxml.env.SimpleErrorReporter;
import org.apache.commons.scxml.env.jexl.JexlContext;
import org.apache.commons.scxml.env.jexl.JexlEvaluator;
import org.apache.commons.scxml.io.SCXMLParser;
import org.apache.commons.scxml.model.State;
import org.xml.sax.InputSource;

/**
 * The ring in Apache Commons SCXML: java Ring STATES GUARDED WARM SECONDS.
 *
 * <p>Prints the events sent, those of them that were timed, their seconds, and the counter.
 */
public final class Ring {
    private static final int BATCH = 1_000;
    private static final String[] GUARDS = {"n lt 0", "n lt -1", "n ge 0"};
    private static final TriggerEvent TICK = new TriggerEvent("tick", TriggerEvent.SIGNAL_EVENT);

    private static String text(int states, boolean guarded) {
        StringBuilder made = new StringBuilder(
            "<scxml xmlns='http://www.w3.org/2005/07/scxml' version='1.0' initialstate='s0'>");
        for (int index = 0; index < states; index++) {
            made.append("<state id='s").append(index).append("'>");
            for (String guard : guarded ? GUARDS : new String[] {"true"}) {
                made.append("<transition event='tick'");
                if (guarded) {
                    made.append(" cond='").append(guard).append("'");
                }
                made.append(" target='s").append((index + 1) % states)
                    .append("'><assign name='n' expr='n + 1'/></transition>");
            }
            made.append("</state>");
        }
        return made.append("</scxml>").toString();
    }

    private static SCXMLExecutor start(String text) throws Exception {
        SCXMLExecutor made = new SCXMLExecutor(
            new JexlEvaluator(), new SimpleDispatcher(), new SimpleErrorReporter());
        made.setStateMachine(
            SCXMLParser.parse(new InputSource(new StringReader(text)), new SimpleErrorHandler()));
        JexlContext context = new JexlContext();
        context.set("n", 0);
        made.setRootContext(context);
        made.go();
        return made;
    }

    public static void main(String[] given) throws Exception {
        SCXMLExecutor ring = start(text(Integer.parseInt(given[0]), given[1].equals("1")));
        long[] before = tickFor(ring, Double.parseDouble(given[2]));
        long[] timed = tickFor(ring, Double.parseDouble(given[3]));
        Set<?> states = ring.getCurrentStatus().getStates();
        String state = ((State) states.iterator().next()).getId().substring(1);
        System.out.printf(
            Locale.ROOT,
            "{\"sent\": %d, \"timed\": %d, \"lasted\": %.6f, \"count\": %s, \"state\": %s}%n",
            before[0] + timed[0], timed[0], timed[1] / 1e9, ring.getRootContext().get("n"), state);
    }

    private static long[] tickFor(SCXMLExecutor ring, double seconds) throws Exception {
        long began = System.nanoTime();
        long lasted = 0;
        long events = 0;
        while (lasted < seconds * 1e9) {
            for (int tick = 0; tick < BATCH; tick++) {
                ring.triggerEvent(TICK);
            }
            events += BATCH;
            lasted = System.nanoTime() - began;
        }
        return new long[] {events, lasted};
    }
}
